# Run by cpack after it has made the packages. It has given the one of the libraries scripts that call ldconfig; Debian's policy asks for
# a trigger instead.
foreach(package IN LISTS CPACK_PACKAGE_FILES)
  if(package MATCHES "/libslom[0-9]+_[^/]*$")
    set(folder "${package}.unpacked")
    file(REMOVE_RECURSE "${folder}")
    execute_process(COMMAND dpkg-deb --raw-extract "${package}" "${folder}" COMMAND_ERROR_IS_FATAL ANY)
    file(REMOVE "${folder}/DEBIAN/postinst" "${folder}/DEBIAN/postrm")
    file(WRITE "${folder}/DEBIAN/triggers" "activate-noawait ldconfig\n")
    execute_process(COMMAND dpkg-deb --root-owner-group --build "${folder}" "${package}" COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
    file(REMOVE_RECURSE "${folder}")
  endif()
endforeach()
