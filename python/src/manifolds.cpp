#include "manifolds.hpp"

#include <cstddef>
#include <sstream>
#include <type_traits>

#include <nanobind/eigen/dense.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "documentation.hpp"
#include "recorded.hpp"
#include "slom/tape/rotation.hpp"
#include "value_type.hpp"

namespace slom::python {

using tape::Number;

nb::object numpy() { return nb::module_::import_("numpy"); }

std::vector<std::size_t> shapeOf(nb::handle x) {
  return nb::cast<std::vector<std::size_t>>(nb::tuple(numpy().attr("shape")(x)));
}

[[noreturn]] void raiseValue(const std::string& subject, const std::string& fault,
                             const std::string& remedy) {
  throw mtk::Error("slom.bad-value", subject + " " + fault + "; " + remedy, subject);
}

nb::object realArray(nb::handle x, const std::string& subject) {
  if (nb::hasattr(x, "mask") && nb::cast<bool>(numpy().attr("ma").attr("is_masked")(x)))
    raiseValue(subject, "has masked entries", "select the rows without them");
  nb::object array;
  try {
    array = numpy().attr("asarray")(x);
  } catch (const nb::python_error&) {
    raiseValue(subject, "is an array whose rows have different lengths",
               "pass numbers, all rows of one length");
  }
  if (nb::cast<std::string>(array.attr("dtype").attr("kind")).find_first_of("biuf") == std::string::npos) {
    raiseValue(
        subject,
        "is " +
            (nb::hasattr(x, "dtype")
                 ? "an array of " + nb::cast<std::string>(nb::str(nb::object(array.attr("dtype")))) + "s"
                 : "a " + nb::cast<std::string>(x.type().attr("__name__"))) +
            " and holds no real numbers",
        "pass a number, an array, one of SO2, SO3, S2, SE2 and SE3, or an instance of a class decorated with "
        "slom.manifold");
  }
  return numpy().attr("ascontiguousarray")(array, "float64").attr("reshape")(array.attr("shape"));
}

namespace {

[[noreturn]] void raiseShape(const std::string& what, const std::string& expected, std::size_t got) {
  throw mtk::Error("slom.wrong-shape",
                   what + " needs " + expected + ", it was given an array of " + std::to_string(got) +
                       "; pass an array of that length",
                   what);
}

}  // namespace

template <>
std::vector<double> entriesOf<double>(nb::handle x, int size, const std::string& what) {
  const nb::object array = realArray(x, what).attr("ravel")();
  const auto values = nb::cast<Eigen::VectorXd>(array);
  if (size >= 0 && values.size() != size)
    raiseShape(what, std::to_string(size) + " numbers", static_cast<std::size_t>(values.size()));
  return {values.begin(), values.end()};
}

template <>
std::vector<Number> entriesOf<Number>(nb::handle x, int size, const std::string& what) {
  std::vector<Number> values;
  appendNumbers(x, values);
  if (size >= 0 && values.size() != static_cast<std::size_t>(size))
    raiseShape(what, std::to_string(size) + " numbers", values.size());
  return values;
}

nb::object toPython(const double* numbers, const std::vector<std::size_t>& shape) {
  if (shape.empty()) return nb::float_(*numbers);
  std::size_t size = 1;
  for (const std::size_t n : shape) size *= n;
  nb::object array =
      nb::cast(Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(numbers, static_cast<Eigen::Index>(size))));
  return shape.size() == 1 ? array : array.attr("reshape")(shape);
}

nb::object toPython(const Number* numbers, const std::vector<std::size_t>& shape) {
  std::size_t size = 1;
  for (const std::size_t n : shape) size *= n;
  return arrayOf({numbers, numbers + size}, shape);
}

namespace {

template <class T>
inline constexpr bool is_pose = mtk::detail::is_trafo<T>;

template <class V>
nb::object vectorToPython(const V& v) {
  return toPython(v.data(), {static_cast<std::size_t>(v.size())});
}
template <class M>
nb::object matrixToPython(const M& m) {
  using S = typename M::Scalar;
  std::vector<S> rows;
  for (Eigen::Index i = 0; i < m.rows(); ++i) {
    for (Eigen::Index k = 0; k < m.cols(); ++k) rows.push_back(m(i, k));
  }
  return toPython(rows.data(), {static_cast<std::size_t>(m.rows()), static_cast<std::size_t>(m.cols())});
}
template <int N, class S>
mtk::vect<N, S> vectorFrom(nb::handle x, const std::string& what) {
  const std::vector<S> entries = entriesOf<S>(x, N, what);
  mtk::vect<N, S> v;
  for (int i = 0; i < N; ++i) v[i] = entries[static_cast<std::size_t>(i)];
  return v;
}
template <int N, class S>
Eigen::Matrix<S, N, N, Eigen::DontAlign> matrixFrom(nb::handle x, const std::string& what) {
  const std::vector<S> entries = entriesOf<S>(x, N * N, what);
  Eigen::Matrix<S, N, N, Eigen::DontAlign> m;
  for (int i = 0; i < N * N; ++i) m(i / N, i % N) = entries[static_cast<std::size_t>(i)];
  return m;
}

template <int N>
mtk::vect<N, Number> constant(const mtk::vect<N>& v) {
  mtk::vect<N, Number> result;
  for (int i = 0; i < N; ++i) result[i] = Number(v[i]);
  return result;
}
mtk::SO2<Number> constant(const mtk::SO2<>& R) { return mtk::SO2<Number>(Number(R.angle())); }
mtk::SO3<Number> constant(const mtk::SO3<>& R) { return mtk::SO3<Number>(R); }
mtk::S2<Number> constant(const mtk::S2<>& v) { return mtk::S2<Number>(constant(v.vector())); }
template <class R>
auto constant(const mtk::trafo<R>& T) {
  const auto orient = constant(T.orient);
  return mtk::trafo<std::remove_const_t<decltype(orient)>>(orient, constant(T.pos));
}

/// Returns x over S, whether it is recorded or not.
template <template <class> class G, class S>
G<S> as(nb::handle x) {
  if constexpr (std::is_same_v<S, double>) {
    return nb::cast<G<double>>(x);
  } else {
    return nb::isinstance<G<Number>>(x) ? nb::cast<G<Number>>(x) : constant(nb::cast<G<double>>(x));
  }
}
template <template <class> class G>
bool isA(nb::handle x) {
  return nb::isinstance<G<double>>(x) || nb::isinstance<G<Number>>(x);
}

/// Returns a times points, whose last axis is the space that `a` acts on.
template <class T>
nb::object moved(const T& a, nb::handle points, const char* name) {
  using S = typename T::scalar;
  const std::vector<std::size_t> shape = shapeOf(points);
  constexpr int dim = T::DIM;
  if (shape.empty() || shape.back() != dim) {
    raiseShape(std::string(name) + " times an array", "points of " + std::to_string(dim) + " numbers",
               shape.empty() ? 1 : shape.back());
  }
  std::vector<S> all = entriesOf<S>(points, -1, name);
  for (std::size_t i = 0; i < all.size(); i += dim) {
    mtk::vect<dim, S> p;
    for (int k = 0; k < dim; ++k) p[k] = all[i + static_cast<std::size_t>(k)];
    const mtk::vect<dim, S> q = a * p;
    for (int k = 0; k < dim; ++k) all[i + static_cast<std::size_t>(k)] = q[k];
  }
  if (all.empty()) return nb::borrow(points);
  return toPython(all.data(), shape);
}

/// Returns a * b over S for a group element a.
template <template <class> class G, template <class> class R, class S>
nb::object productOver(nb::handle a, nb::handle b, const char* name) {
  const G<S> x = as<G, S>(a);
  if (isA<G>(b)) return nb::cast(G<S>(x * as<G, S>(b)));
  if constexpr (is_pose<G<S>>) {
    if (isA<R>(b)) return nb::cast(G<S>(x * as<R, S>(b)));
  } else {
    if (isA<R>(b)) return nb::cast(R<S>(R<S>(x) * as<R, S>(b)));  // R: the poses
    if constexpr (std::is_same_v<G<S>, mtk::SO3<S>>) {
      if (isA<mtk::S2>(b)) return nb::cast(mtk::S2<S>(x * as<mtk::S2, S>(b)));
    }
  }
  return moved(x, b, name);
}
template <template <class> class G, template <class> class R>
nb::object product(nb::handle a, nb::handle b, const char* name) {
  if (nb::isinstance<Rows>(b)) return nb::borrow(nb::handle(Py_NotImplemented));  // Rows have the operator
  const bool recorded = nb::isinstance<G<Number>>(a) || isRecorded(b);
  return recorded ? productOver<G, R, Number>(a, b, name) : productOver<G, R, double>(a, b, name);
}

template <template <class> class G, class S>
nb::object differenceOver(nb::handle x, nb::handle y) {
  return vectorToPython(mtk::difference(as<G, S>(x), as<G, S>(y)));
}
template <template <class> class G>
nb::object difference(nb::handle x, nb::handle y, const char* name) {
  if (!isA<G>(y)) {
    throw mtk::Error("slom.bad-operand",
                     std::string("an ") + name + " is compared with a value of type " +
                         nb::cast<std::string>(y.type().attr("__name__")) + "; compare it with another " +
                         name,
                     name);
  }
  const bool recorded = nb::isinstance<G<Number>>(x) || nb::isinstance<G<Number>>(y);
  return recorded ? differenceOver<G, Number>(x, y) : differenceOver<G, double>(x, y);
}

template <template <class> class G, class S>
nb::object movedBy(nb::handle x, nb::handle d, const char* name) {
  G<S> y = as<G, S>(x);
  const std::vector<S> tangent = entriesOf<S>(d, G<S>::DOF, std::string("a perturbation of ") + name);
  y.boxplus(mtk::vectview<const S, G<S>::DOF>(tangent.data()), S(1));
  return nb::cast(y);
}
template <template <class> class G>
nb::object boxplus(nb::handle x, nb::handle d, const char* name) {
  return nb::isinstance<G<Number>>(x) || isRecorded(d) ? movedBy<G, Number>(x, d, name)
                                                       : movedBy<G, double>(x, d, name);
}

template <class T>
std::string textOf(const T& x, const char* name) {
  if constexpr (!std::is_same_v<typename T::scalar, double>) {
    return std::string("<recorded ") + name + ">";
  } else {
    std::ostringstream text;
    text << name << '(';
    if constexpr (is_pose<T>) {
      text << "pos=[";
      for (int i = 0; i < T::DIM; ++i) text << (i == 0 ? "" : ", ") << x.pos[i];
      text << "], orient=" << textOf(x.orient, T::DIM == 2 ? "SO2" : "SO3");
    } else if constexpr (std::is_same_v<T, mtk::SO3<double>>) {
      text << "w=" << x.w() << ", x=" << x.x() << ", y=" << x.y() << ", z=" << x.z();
    } else if constexpr (std::is_same_v<T, mtk::SO2<double>>) {
      text << x.angle();
    } else {
      text << x.x() << ", " << x.y() << ", " << x.z();
    }
    text << ')';
    return text.str();
  }
}

/// Returns whether two values are the same, to the last bit. Opposite quaternions are the same rotation.
bool isSame(const mtk::SO2<double>& x, const mtk::SO2<double>& y) { return x.angle() == y.angle(); }
bool isSame(const mtk::SO3<double>& x, const mtk::SO3<double>& y) {
  return x.coeffs() == y.coeffs() || x.coeffs() == -y.coeffs();
}
bool isSame(const mtk::S2<double>& x, const mtk::S2<double>& y) { return x.vector() == y.vector(); }
template <class R>
bool isSame(const mtk::trafo<R>& x, const mtk::trafo<R>& y) {
  return x.pos == y.pos && isSame(x.orient, y.orient);
}

[[noreturn]] void raiseArguments(const char* name, const char* accepted) {
  throw mtk::Error("slom.bad-argument",
                   std::string(name) + " was given arguments that do not make one; pass " + accepted, name);
}

template <class S>
nb::object makeSO2(const nb::args& args) {
  if (args.size() == 0) return nb::cast(mtk::SO2<S>());
  const nb::object x = args[0];
  if (args.size() == 1 && isA<mtk::SO2>(x)) return nb::borrow(x);
  if (args.size() == 1 && shapeOf(x).size() < 2)
    return nb::cast(mtk::SO2<S>(entriesOf<S>(x, 1, "SO2(angle)").front()));
  if (args.size() == 1) return nb::cast(mtk::SO2<S>(matrixFrom<2, S>(x, "SO2(matrix)")));
  raiseArguments("SO2", "the angle [rad], or a 2 x 2 rotation matrix");
}
template <class S>
nb::object makeSO3(const nb::args& args) {
  if (args.size() == 0) return nb::cast(mtk::SO3<S>());
  if (args.size() == 1 && isA<mtk::SO3>(args[0])) return nb::borrow(nb::object(args[0]));
  if (args.size() == 1 && nb::hasattr(args[0], "as_quat")) {  // scipy.spatial.transform.Rotation
    const std::vector<S> q = entriesOf<S>(nb::object(args[0].attr("as_quat")()), 4, "SO3(rotation)");
    return nb::cast(mtk::SO3<S>(q[3], q[0], q[1], q[2]));
  }
  if (args.size() == 4) {
    const std::vector<S> q = entriesOf<S>(args, 4, "SO3(w, x, y, z)");
    return nb::cast(mtk::SO3<S>(q[0], q[1], q[2], q[3]));
  }
  if (args.size() == 1 && shapeOf(args[0]).size() == 2) {
    if constexpr (std::is_same_v<S, double>) {
      return nb::cast(mtk::SO3<S>(matrixFrom<3, S>(args[0], "SO3(matrix)")));
    } else {
      raiseArguments("SO3 of recorded numbers",
                     "the quaternion (w, x, y, z), or the rotation vector to SO3.exp");
    }
  }
  raiseArguments("SO3",
                 "the quaternion (w, x, y, z) or a 3 x 3 rotation matrix; SO3.exp takes a rotation vector");
}
template <class S>
nb::object makeS2(const nb::args& args) {
  if (args.size() == 0) return nb::cast(mtk::S2<S>());
  if (args.size() == 1 && isA<mtk::S2>(args[0])) return nb::borrow(nb::object(args[0]));
  if (args.size() == 1) return nb::cast(mtk::S2<S>(vectorFrom<3, S>(args[0], "S2(vector)")));
  if (args.size() == 3) return nb::cast(mtk::S2<S>(vectorFrom<3, S>(args, "S2(x, y, z)")));
  raiseArguments("S2", "a vector of any positive length");
}
/// Returns a pose of position and orientation in any order, one of them, or its matrix.
template <template <class> class G, template <class> class R, class S>
nb::object makePose(nb::handle pos, nb::handle orient, const char* name, const char* accepted) {
  constexpr int dim = G<S>::DIM;
  if (isA<R>(pos)) std::swap(pos, orient);
  if (dim == 2 && orient.is_none() && !pos.is_none() && !isA<G>(pos) &&
      shapeOf(pos) == std::vector<std::size_t>{3})
    raiseArguments(name, "SE2(x, y, angle), or SE2([x, y], angle)");
  if (isA<G>(pos) && orient.is_none()) return nb::borrow(pos);
  G<S> T;
  if (!pos.is_none() && orient.is_none() && shapeOf(pos).size() == 2) {
    if constexpr (std::is_same_v<S, double>) {
      const auto m = matrixFrom<dim + 1, S>(pos, std::string(name) + "(matrix)");
      for (int k = 0; k <= dim; ++k) {
        if (!(std::abs(m(dim, k) - (k == dim ? 1 : 0)) <= 1e-6))
          raiseArguments(
              name, "a matrix whose last row is 0 ... 0 1, or its transpose if the translation is there");
      }
      return nb::cast(G<S>(R<S>(m.template topLeftCorner<dim, dim>()),
                           mtk::vect<dim, S>(m.template topRightCorner<dim, 1>())));
    } else {
      raiseArguments((std::string(name) + " of recorded numbers").c_str(), "position and orientation");
    }
  }
  if (!pos.is_none()) T.pos = vectorFrom<dim, S>(pos, std::string("the position of ") + name);
  if (!orient.is_none()) {
    if (isA<R>(orient)) {
      T.orient = as<R, S>(orient);
    } else if constexpr (dim == 2) {
      T.orient = R<S>(entriesOf<S>(orient, 1, "the angle of SE2").front());
    } else {
      raiseArguments(name, accepted);
    }
  }
  return nb::cast(T);
}
template <template <class> class G, template <class> class R>
nb::object pose(nb::handle pos, nb::handle orient, const char* name, const char* accepted) {
  const bool recorded = isRecorded(pos) || isRecorded(orient);
  return recorded ? makePose<G, R, Number>(pos, orient, name, accepted)
                  : makePose<G, R, double>(pos, orient, name, accepted);
}
bool isAnyRecorded(const nb::args& args) {
  for (const nb::handle x : args) {
    if (isRecorded(x)) return true;
  }
  return false;
}

/// Declares what all kinds have in common, for numbers or for recorded numbers.
template <template <class> class G, class S>
nb::class_<G<S>> bindOne(nb::module_& module, const char* name, const char* doc) {
  using namespace nb::literals;
  const std::string class_name = std::is_same_v<S, double> ? name : std::string("Recorded") + name;
  nb::class_<G<S>> c(module, class_name.c_str(), doc);
  c.def(
       "boxminus", [name](nb::handle x, nb::handle y) { return difference<G>(x, y, name); }, "y"_a,
       "Returns self [-] y, the shortest perturbation that moves y here.")
      .def("__sub__", [name](nb::handle x, nb::handle y) { return difference<G>(x, y, name); })
      .def(
          "boxplus", [name](nb::handle x, nb::handle d) { return boxplus<G>(x, d, name); }, "d"_a,
          "Returns self [+] d.")
      .def("__add__", [name](nb::handle x, nb::handle d) { return boxplus<G>(x, d, name); })
      .def("__eq__",
           [name](const G<S>& x, nb::handle y) -> nb::object {
             if (!isA<G>(y)) return nb::borrow(nb::handle(Py_NotImplemented));
             if constexpr (std::is_same_v<S, double>) {
               if (nb::isinstance<G<double>>(y)) return nb::cast(isSame(x, nb::cast<G<double>>(y)));
             }
             throw mtk::Error(
                 "slom.traced-comparison",
                 std::string("an ") + name +
                     " of recorded numbers is compared by ==; compare numbers of a - b by < or slom.where",
                 name);
           })
      .def("__copy__", [](const G<S>& x) { return x; })
      .def("__deepcopy__", [](const G<S>& x, nb::handle) { return x; })
      .def("__repr__", [name](const G<S>& x) { return textOf(x, name); });
  c.attr("__array_ufunc__") = nb::none();  // so that NumPy's arrays leave operators to this class
  c.attr("__hash__") = nb::none();
  return c;
}
/// Declares what groups have in common. R: the poses of a rotation, the rotations of a pose.
template <template <class> class G, template <class> class R, class S>
nb::class_<G<S>> bindGroup(nb::module_& module, const char* name, const char* doc) {
  nb::class_<G<S>> c = bindOne<G, S>(module, name, doc);
  const auto times = [name](nb::handle a, nb::handle b) { return product<G, R>(a, b, name); };
  c.def("__mul__", times)
      .def("__matmul__", times)
      .def(
          "inverse", [](const G<S>& x) { return x.inverse(); }, "Returns the inverse.")
      .def(
          "matrix",
          [](const G<S>& x) {
            if constexpr (is_pose<G<S>>) {
              return matrixToPython(x.matrix());
            } else {
              return matrixToPython(x.toRotationMatrix());
            }
          },
          "Returns the matrix.");
  return c;
}

template <class S>
void bindAll(nb::module_& module) {
  using namespace nb::literals;
  auto so2 = bindGroup<mtk::SO2, SE2, S>(module, "SO2", doc::SO2);
  so2.def_prop_ro(
         "angle", [](const mtk::SO2<S>& R) { return R.angle(); }, "The angle in [-pi, pi) [rad].")
      .def(
          "log", [](const mtk::SO2<S>& R) { return R.angle(); }, "Returns the angle [rad].");
  auto so3 = bindGroup<mtk::SO3, SE3, S>(module, "SO3", doc::SO3);
  so3.def(
         "log", [](const mtk::SO3<S>& R) { return vectorToPython(mtk::SO3<S>::log(R)); },
         "Returns the rotation vector, axis times angle [rad].")
      .def_prop_ro("w", [](const mtk::SO3<S>& R) { return R.w(); })
      .def_prop_ro("x", [](const mtk::SO3<S>& R) { return R.x(); })
      .def_prop_ro("y", [](const mtk::SO3<S>& R) { return R.y(); })
      .def_prop_ro("z", [](const mtk::SO3<S>& R) { return R.z(); })
      .def_prop_ro(
          "coefficients", [](const mtk::SO3<S>& R) { return vectorToPython(R.coeffs()); },
          "The unit quaternion (x, y, z, w), in the order of SciPy.");
  auto s2 = bindOne<mtk::S2, S>(module, "S2", doc::S2);
  s2.def_prop_ro(
        "vector", [](const mtk::S2<S>& v) { return vectorToPython(v.vector()); }, "The unit vector.")
      .def_prop_ro("x", [](const mtk::S2<S>& v) { return v.x(); })
      .def_prop_ro("y", [](const mtk::S2<S>& v) { return v.y(); })
      .def_prop_ro("z", [](const mtk::S2<S>& v) { return v.z(); });
  const auto parts = [](auto& c) {
    using T = typename std::remove_cvref_t<decltype(c)>::Type;
    c.def_prop_ro(
         "pos", [](const T& x) { return vectorToPython(x.pos); }, "The position.")
        .def_prop_ro(
            "orient", [](const T& x) { return x.orient; }, "The orientation.");
  };
  auto se2 = bindGroup<SE2, mtk::SO2, S>(module, "SE2", doc::SE2);
  parts(se2);
  auto se3 = bindGroup<SE3, mtk::SO3, S>(module, "SE3", doc::SE3);
  parts(se3);
  if constexpr (std::is_same_v<S, double>) {
    so2.def(nb::new_([](const nb::args& args) {
         return isAnyRecorded(args) ? makeSO2<Number>(args) : makeSO2<double>(args);
       }))
        .def_static(
            "exp",
            [](nb::handle angle) {
              return isRecorded(angle)
                         ? nb::cast(mtk::SO2<Number>(entriesOf<Number>(angle, 1, "SO2.exp").front()))
                         : nb::cast(mtk::SO2<double>(entriesOf<double>(angle, 1, "SO2.exp").front()));
            },
            "angle"_a, "Returns the rotation by the angle [rad], counter-clockwise.");
    so3.def(nb::new_([](const nb::args& args) {
         return isAnyRecorded(args) ? makeSO3<Number>(args) : makeSO3<double>(args);
       }))
        .def_static(
            "exp",
            [](nb::handle v) {
              return isRecorded(v) ? nb::cast(mtk::SO3<Number>::exp(vectorFrom<3, Number>(v, "SO3.exp")))
                                   : nb::cast(mtk::SO3<double>::exp(vectorFrom<3, double>(v, "SO3.exp")));
            },
            "vector"_a, "Returns the rotation by the vector, axis times angle [rad].");
    s2.def(nb::new_([](const nb::args& args) {
      return isAnyRecorded(args) ? makeS2<Number>(args) : makeS2<double>(args);
    }));
    se2.def(nb::new_([](nb::handle pos, nb::handle orient, nb::handle angle) {
              if (angle.is_none())
                return pose<SE2, mtk::SO2>(pos, orient, "SE2", "a position, and an orientation or angle");
              nb::list xy;
              xy.append(pos);
              xy.append(orient);
              return pose<SE2, mtk::SO2>(xy, angle, "SE2", "x, y and the angle");
            }),
            "pos"_a = nb::none(), "orient"_a = nb::none(), "angle"_a = nb::none());
    se3.def(nb::new_([](nb::handle pos, nb::handle orient) {
              return pose<SE3, mtk::SO3>(pos, orient, "SE3", "a position and an SO3");
            }),
            "pos"_a = nb::none(), "orient"_a = nb::none());
    so2.def("__reduce__",
            [](nb::handle x) { return nb::make_tuple(x.type(), nb::make_tuple(x.attr("angle"))); });
    so3.def("__reduce__", [](nb::handle x) {
      return nb::make_tuple(x.type(), nb::make_tuple(x.attr("w"), x.attr("x"), x.attr("y"), x.attr("z")));
    });
    s2.def("__reduce__",
           [](nb::handle x) { return nb::make_tuple(x.type(), nb::make_tuple(x.attr("vector"))); });
    const auto reducePose = [](nb::handle x) {
      return nb::make_tuple(x.type(), nb::make_tuple(x.attr("pos"), x.attr("orient")));
    };
    se2.def("__reduce__", reducePose);
    se3.def("__reduce__", reducePose);
  }
}

}  // namespace

bool isRecorded(nb::handle x) {
  if (nb::isinstance<Number>(x) || nb::isinstance<mtk::SO2<Number>>(x) ||
      nb::isinstance<mtk::SO3<Number>>(x) || nb::isinstance<mtk::S2<Number>>(x) ||
      nb::isinstance<SE2<Number>>(x) || nb::isinstance<SE3<Number>>(x))
    return true;
  if (nb::isinstance<nb::list>(x) || nb::isinstance<nb::tuple>(x)) {
    for (const nb::handle entry : x) {
      if (isRecorded(entry)) return true;
    }
    return false;
  }
  return nb::hasattr(x, "dtype") && nb::cast<std::string>(nb::object(x.attr("dtype").attr("kind"))) == "O";
}

void bindManifolds(nb::module_& module) {
  bindAll<double>(module);
  bindAll<Number>(module);
}

}  // namespace slom::python
