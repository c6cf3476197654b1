/// Archive: saves a problem to a text file and loads it again. The file holds values, data, noise, losses, names, and
/// what is fixed or bounded.
///
///     slom::Archive archive;  // handles the types that are registered with it
///     archive.measurement<slom::RelativePose, slom::VarID<Pose>, slom::VarID<Pose>, slom::Measured<Pose>>();
///     archive.measurement<Observation>();  // declared by SLOM_BUILD_MEASUREMENT
///     archive.measurement<slom::GaussianPrior>();
///     archive.save(est, file);
///
///     slom::StoredProblem problem = archive.load(file);
///     std::cout << problem.estimator.optimize().report() << *problem.variable<Pose>("start");
///
/// The types of a callable's arguments are those of the call of insertMeasurement:
///   variable               VarID<T>
///   measured(z)            Measured<Z>
///   other data             the type itself
///   list of variables      std::vector<AnyVarID>, first
/// Traced measurements (slom/tape.hpp) need no registration: the file holds their tapes and describes their variables.
/// Where the type of such a variable is not registered, load makes it a variable of a RuntimeType.
/// Values and data are written and read by their stream operators, with 17 digits. So a loaded problem equals the saved
/// one except for rounding in the last digit. docs/saved_problem.md describes the format.
#pragma once

#include <concepts>
#include <iosfwd>
#include <string>
#include <tuple>
#include <type_traits>
#include <typeindex>
#include <utility>
#include <vector>

#include "slom/datum_stream.hpp"
#include "slom/estimator.hpp"
#include "slom/measurements/gaussian_prior.hpp"
#include "slom/stored_problem.hpp"

namespace slom {

class Archive {
 public:
  /// Registers measurements of a type declared by SLOM_BUILD_MEASUREMENT, or of a callable with these arguments. A
  /// callable must be a function object without captures or members. `name` is the kind's name in the file. Without a
  /// name, it is made of the names of the types, which suffices if these differ. If a function's meaning differs from
  /// that in earlier files, give it a member `archive_suffix`, which is appended to the name, as slom::RelativePose
  /// has. Throws [slom.archive-name] if the name already has another meaning.
  template <class F, class... Args>
  void measurement(std::string name = "");
  /// Sets the name of a variable type in the file, in place of the type's own name. Call it before registering
  /// measurements of such variables.
  template <class T>
  void variable(std::string name);

  /// Writes a problem. Throws [slom.not-in-archive] for measurements that are not registered, and [slom.not-savable]
  /// for values and data that cannot be read again, such as NaN.
  void save(const Estimator& estimator, std::ostream& os) const;
  /// Reads a problem. `source` is the name of the stream in messages. Throws [slom.bad-archive] with the line.
  StoredProblem load(std::istream& is, const std::string& source = "the problem") const;

 private:
  template <class F, class... Args>
  struct Kind;
  template <class F, class... Data>
  struct ListKind;
  template <class M>
  struct DeclaredKind;
  template <class T>
  void knowVariable(std::string name = "");
  void add(detail::StoredVariable kind, bool is_named);
  void add(detail::StoredMeasurement kind);
  const detail::StoredVariable* findVariable(std::type_index type) const;

  friend class ArchiveReader;
  static Problem& problemOf(const Estimator& estimator);
  template <class T>
  static VarID<T> idOf(const VariableHandle& handle) {
    return VarID<T>(handle);
  }

  std::vector<detail::StoredVariable> variables_;
  std::vector<detail::StoredMeasurement> measurements_;
};

// ---- implementation

template <class T>
void Archive::variable(std::string name) {
  knowVariable<T>(std::move(name));
}

template <class T>
void Archive::knowVariable(std::string name) {
  static_assert(std::is_default_constructible_v<T>,
                "slom: to be loaded, a variable type needs a default constructor");
  static_assert(mtk::isWritable<T>(),
                "slom: to be saved, this variable type or one of its parts needs an operator<<");
  const bool is_named = !name.empty();
  using Stored = detail::StoredVariable;
  add({is_named ? std::move(name) : typeName<T>(), typeid(VariableStore<T>),
       [](const Stored&, std::ostream& os, const void* value) {
         mtk::write(os, *static_cast<const T*>(value));
       },
       [](const Stored&, std::istream& is, Problem* problem, bool optimize, const std::string& own_name,
          VariableHandle& id) {
         T value{};
         if (!mtk::read(is, value)) return false;
         if (problem != nullptr) id = problem->insertVariable<T>(value, optimize, own_name);
         return true;
       },
       [](const Stored&, std::istream& is, void* context, void (*take)(void*, const void*, int)) {
         T value{};
         if (!mtk::read(is, value)) return false;
         take(context, &value, mtk::dof(value));
         return true;
       },
       [](const Stored&, detail::TracedType& traced) { return detail::describe<T>(traced); }},
      is_named);
}

/// Reads and writes a callable: its stored arguments are the data.
template <class F, class... Args>
struct Archive::Kind {
  using M = CallableMeasurement<F, Args...>;
  static_assert(
      std::is_empty_v<F> && std::is_default_constructible_v<F>,
      "slom: only function objects without captures or members can be loaded: pass captured values as "
      "further arguments of insertMeasurement, and wrap a function in a lambda");

  template <class A>
  struct Argument {
    static std::string name() { return "datum " + typeName<A>(); }
    static void know(Archive&, std::vector<std::type_index>&) {}
    A value{};
    bool read(std::istream& is) { return detail::readDatum(is, value); }
    A take(const VariableHandle*&) { return std::move(value); }
  };
  template <class T>
  struct Argument<VarID<T>> {
    static std::string name() { return typeName<T>(); }
    static void know(Archive& archive, std::vector<std::type_index>& variables) {
      archive.knowVariable<T>();
      variables.push_back(typeid(VariableStore<T>));
    }
    bool read(std::istream&) { return true; }
    VarID<T> take(const VariableHandle*& next) { return idOf<T>(*next++); }
  };
  template <class Z>
  struct Argument<Measured<Z>> {
    static std::string name() { return "measured " + typeName<Z>(); }
    static void know(Archive&, std::vector<std::type_index>&) {}
    Z value{};
    bool read(std::istream& is) { return detail::readDatum(is, value); }
    Measured<Z> take(const VariableHandle*&) { return {value}; }
  };

  static std::string name() {
    std::string all;
    ((all += (all.empty() ? "" : ", ") + Argument<Args>::name()), ...);
    if constexpr (requires { F::archive_name; }) {
      return std::string(F::archive_name) + "(" + all + ")";
    } else {
      return typeName<F>() + "(" + all + ")";
    }
  }
  static std::string suffix() {
    if constexpr (requires { F::archive_suffix; }) {
      return std::string(F::archive_suffix);
    } else {
      return "";
    }
  }
  static void know(Archive& archive, std::vector<std::type_index>& variables) {
    (Argument<Args>::know(archive, variables), ...);
  }
  static void write(std::ostream& os, const detail::StoredArguments&, const MeasurementPool& pool, int i) {
    const auto one = [&]<class Stored>(const Stored& stored) {
      if constexpr (!std::is_base_of_v<VariableArgument, Stored>)
        detail::writeDatum(os, detail::contentOf(stored));
    };
    detail::applyTo(static_cast<const TypedPool<M>&>(pool)[i].arguments(),
                    [&](const auto&... stored) { (one(stored), ...); });
  }
  static bool read(std::istream& is, Problem* problem, const detail::StoredArguments& stored,
                   const detail::StoredOptions& options) {
    const VariableHandle* variables = stored.handles;
    std::tuple<Argument<Args>...> arguments;
    const bool good = std::apply([&](auto&... argument) { return (argument.read(is) && ...); }, arguments);
    if (good && problem != nullptr) {
      std::apply(
          [&](auto&... argument) {
            // braces evaluate from left to right, the order of the variables
            const std::tuple<Args...> all{argument.take(variables)...};
            problem->insertMeasurement(std::apply([](const Args&... a) { return M(F(), a...); }, all),
                                       options.noise, options.label, options.loss);
          },
          arguments);
    }
    return good;
  }
};

/// Reads and writes a callable over a list of variables.
template <class F, class... Data>
struct Archive::ListKind {
  using M = ListMeasurement<F, Data...>;
  static_assert(
      std::is_empty_v<F> && std::is_default_constructible_v<F>,
      "slom: only function objects without captures or members can be loaded: pass captured values as "
      "further arguments of insertMeasurement, and wrap a function in a lambda");

  static std::string name() {
    return typeName<F>() + "(variables" + (std::string() + ... + (", datum " + typeName<Data>())) + ")";
  }
  static void write(std::ostream& os, const detail::StoredArguments&, const MeasurementPool& pool, int i) {
    detail::applyTo(static_cast<const M*>(pool.runtimeMeasurement(i))->data(),
                    [&](const auto&... datum) { (detail::writeDatum(os, datum), ...); });
  }
  static bool read(std::istream& is, Problem* problem, const detail::StoredArguments& stored,
                   const detail::StoredOptions& options) {
    std::tuple<Data...> data;
    if (!std::apply([&](auto&... datum) { return (detail::readDatum(is, datum) && ...); }, data))
      return false;
    if (problem == nullptr) return true;
    std::vector<AnyVarID> ids;
    for (int k = 0; k < stored.count; ++k) ids.emplace_back(stored.handles[k]);
    problem->insertMeasurement(std::apply([&](const auto&... datum) { return M(ids, F(), datum...); }, data),
                               options.noise, options.label, options.loss);
    return true;
  }
};

/// Reads and writes a type declared by SLOM_BUILD_MEASUREMENT.
template <class M>
struct Archive::DeclaredKind {
  using Variables = decltype(std::declval<M&>().variableArgs());
  using Data = decltype(std::declval<const M&>().dataArgs());

  static std::string name() { return typeName<M>(); }
  static std::string suffix() { return ""; }
  static void know(Archive& archive, std::vector<std::type_index>& variables) {
    [&]<class... T>(std::type_identity<detail::VariableList<T...>>) {
      (archive.knowVariable<T>(), ...);
      (variables.push_back(typeid(VariableStore<T>)), ...);
    }(std::type_identity<Variables>{});
  }
  static void write(std::ostream& os, const detail::StoredArguments&, const MeasurementPool& pool, int i) {
    std::apply([&](const auto&... datum) { (detail::writeDatum(os, datum), ...); },
               static_cast<const TypedPool<M>&>(pool)[i].dataArgs());
  }
  static bool read(std::istream& is, Problem* problem, const detail::StoredArguments& stored,
                   const detail::StoredOptions& options) {
    const VariableHandle* const variables = stored.handles;
    return [&]<class... T, class... D>(std::type_identity<detail::VariableList<T...>>,
                                       std::type_identity<std::tuple<const D&...>>) {
      std::tuple<D...> data;
      if (!std::apply([&](auto&... datum) { return (detail::readDatum(is, datum) && ...); }, data))
        return false;
      if (problem == nullptr) return true;
      const auto ids = [&]<std::size_t... I>(std::index_sequence<I...>) {
        return std::tuple<VarID<T>...>(idOf<T>(variables[I])...);
      }(std::index_sequence_for<T...>{});
      problem->insertMeasurement(std::make_from_tuple<M>(std::tuple_cat(ids, data)), options.noise,
                                 options.label, options.loss);
      return true;
    }(std::type_identity<Variables>{}, std::type_identity<Data>{});
  }
};

template <class F, class... Args>
void Archive::measurement(std::string name) {
  const auto addKind = [&]<class K>(std::type_identity<K>, std::type_index type) {
    std::vector<std::type_index> variables;
    K::know(*this, variables);
    add(detail::StoredMeasurement{(name.empty() ? K::name() : std::move(name)) + K::suffix(), type,
                                  std::move(variables), false, &K::write, &K::read});
  };
  const auto addList = [&]<class K>(std::type_identity<K>, std::type_index type) {
    add(detail::StoredMeasurement{
        name.empty() ? K::name() : std::move(name), type, {}, true, &K::write, &K::read});
  };
  if constexpr (std::derived_from<F, RuntimeMeasurement>) {
    static_assert(
        std::is_same_v<F, GaussianPrior> && sizeof...(Args) == 0,
        "slom: among classes over a list of variables, only slom::GaussianPrior can be saved; register it "
        "without further types");
    addList(std::type_identity<StoredPrior>{}, typeid(F));
  } else if constexpr (detail::begins_with_list<Args...>) {
    [&]<class... Data>(std::type_identity<std::tuple<std::vector<AnyVarID>, Data...>>) {
      using Function = std::remove_const_t<F>;
      addList(std::type_identity<ListKind<Function, Data...>>{}, typeid(ListMeasurement<Function, Data...>));
    }(std::type_identity<std::tuple<Args...>>{});
  } else if constexpr (Measurement<F>) {
    static_assert(
        sizeof...(Args) == 0,
        "slom: a type declared by SLOM_BUILD_MEASUREMENT already lists its variables and data; register "
        "it without further types");
    addKind(std::type_identity<DeclaredKind<F>>{}, typeid(F));
  } else {
    using Function = std::remove_const_t<F>;  // the type of a constexpr lambda is const
    addKind(std::type_identity<Kind<Function, Args...>>{}, typeid(CallableMeasurement<Function, Args...>));
  }
}

}  // namespace slom
