"""Conan 2 recipe of the libraries; the command is not part of the package: conan create packaging/conan."""
import os
import re

from conan import ConanFile
from conan.tools.build import check_min_cppstd
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout
from conan.tools.files import copy, load, rm, rmdir


class SlomRecipe(ConanFile):
    name = "slom"
    license = "BSD-3-Clause"
    description = "Sparse least squares on manifolds: model fitting with named variables, uncertainty and diagnostics"
    topics = ("least-squares", "manifolds", "slam", "calibration", "optimization")
    package_type = "library"
    settings = "os", "arch", "compiler", "build_type"
    options = {"shared": [True, False], "fPIC": [True, False], "with_tbb": [True, False]}
    default_options = {"shared": False, "fPIC": True, "with_tbb": True}
    implements = ["auto_shared_fpic"]

    @property
    def _checkout(self):
        return os.path.join(self.recipe_folder, "..", "..")

    def set_version(self):
        text = load(self, os.path.join(self._checkout, "include", "slom", "version.hpp"))
        self.version = ".".join(re.findall(r"#define SLOM_VERSION_\w+ (\d+)", text))

    def export_sources(self):
        for pattern in ("CMakeLists.txt", "LICENSE", "README.md", "CHANGELOG.md", "cmake/*", "docs/*", "include/*", "src/*", "packaging/*"):
            copy(self, pattern, src=self._checkout, dst=self.export_sources_folder)

    def validate(self):
        check_min_cppstd(self, 20)

    def requirements(self):
        self.requires("eigen/3.4.0", transitive_headers=True)
        self.requires("fmt/10.2.1")
        self.requires("bzip2/1.0.8")
        if self.options.with_tbb:
            self.requires("onetbb/2021.12.0")

    def layout(self):
        cmake_layout(self)

    def generate(self):
        CMakeDeps(self).generate()
        toolchain = CMakeToolchain(self)
        toolchain.cache_variables.update({
            "SLOM_BUILD_IO": True, "SLOM_BUILD_CALIBRATION": True, "SLOM_BUILD_APPS": False, "SLOM_BUILD_TESTS": False,
            "SLOM_BUILD_EXAMPLES": False, "SLOM_WITH_TBB": bool(self.options.with_tbb),
            # AMD and METIS of the system would be found, which the package could not name.
            "SLOM_AMD_LIBRARY": "", "SLOM_METIS_LIBRARY": ""})
        toolchain.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        CMake(self).install()
        copy(self, "LICENSE", src=self.source_folder, dst=os.path.join(self.package_folder, "licenses"))
        rmdir(self, os.path.join(self.package_folder, "lib", "cmake"))
        rmdir(self, os.path.join(self.package_folder, "lib", "pkgconfig"))
        rmdir(self, os.path.join(self.package_folder, "share"))
        rm(self, "*.own_eigen", self.package_folder, recursive=True)

    def package_info(self):
        self.cpp_info.set_property("cmake_file_name", "slom")
        mtk = self.cpp_info.components["mtk"]
        mtk.set_property("cmake_target_name", "mtk::mtk")
        mtk.set_property("pkg_config_name", "mtk")
        mtk.libdirs = []
        mtk.requires = ["eigen::eigen"]
        slom = self.cpp_info.components["slom"]
        slom.set_property("cmake_target_name", "slom::slom")
        slom.set_property("pkg_config_name", "slom")
        slom.libs = ["slom"]
        slom.requires = ["mtk"] + (["onetbb::onetbb"] if self.options.with_tbb else [])
        if self.settings.os == "Linux":
            slom.system_libs = ["m", "pthread"]
        for name, requires in (("io", ["slom", "fmt::fmt", "bzip2::bzip2"]), ("calibration", ["slom", "io", "fmt::fmt"])):
            component = self.cpp_info.components[name]
            component.set_property("cmake_target_name", f"slom::{name}")
            component.libs = [f"slom_{name}"]
            component.requires = requires
