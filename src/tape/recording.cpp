#include "slom/tape/recording.hpp"

#include <atomic>
#include <bit>
#include <cmath>
#include <limits>

#include "mtk/error.hpp"
#include "tape/assemble.hpp"
#include "tape/derivatives.hpp"

namespace slom::tape {

namespace {
std::atomic<std::uint32_t> last_number = 0;  // of recordings of all threads; 0 stands for constants
}  // namespace

struct Recording::State {
  State* outer = nullptr;
  std::uint32_t number = 0;
  Graph graph;
  StatedDerivatives stated;
  std::vector<VariableType> variables;
  std::vector<Id> unknowns;
  Id coordinates = 0, tangents = 0;
  std::vector<double> values;
  std::vector<Place> places;

  static State*& current() {
    thread_local State* state = nullptr;
    return state;
  }
};

namespace detail {

struct Access {
  using State = Recording::State;

  static State& current() {
    State* const state = State::current();
    if (state == nullptr) raiseElsewhere();
    return *state;
  }
  [[noreturn]] static void raiseElsewhere() {
    throw mtk::Error(
        "slom.traced-elsewhere",
        "a number of a traced measurement function is used outside of the call that made it; do not "
        "keep numbers from one call to the next",
        "slom::traced");
  }
  template <class X>
  static Id idOf(State& state, const X& x) {
    if (x.recording_ == 0) return state.graph.constant(static_cast<double>(x.value_));
    if (x.recording_ != state.number) raiseElsewhere();
    return x.node_;
  }
  template <class X>
  static X made(State& state, Id id) {
    constexpr Id most = 1'000'000;
    if (id > most) {
      throw mtk::Error("slom.traced-too-long",
                       "a measurement function records more than " + std::to_string(most) +
                           " operations; loop over fewer data, or pass the function without recording it",
                       "slom::traced");
    }
    X x(0);
    if (state.graph.isConstant(id)) {
      if constexpr (std::is_same_v<X, Number>) {
        x.value_ = state.graph[id].value;
      } else {
        x.value_ = state.graph[id].value != 0;
      }
    } else {
      if constexpr (std::is_same_v<X, Number>) x.value_ = std::numeric_limits<double>::quiet_NaN();
      x.node_ = id;
      x.recording_ = state.number;
    }
    return x;
  }
  static std::string placeOf(const Condition& condition) {
    const State& state = current();
    if (condition.recording_ != state.number) return "";
    const std::uint32_t place = state.graph[condition.node_].place;
    if (place == 0) return "";
    const Place& own = state.places[place - 1];
    return " at " + own.file + ":" + std::to_string(own.line);
  }
};

Number apply(Operation operation, const Number& a) {
  if (a.isConstant()) return Number(evaluate(operation, a.constant(), 0, 0));
  auto& state = Access::current();
  return Access::made<Number>(state, state.graph.make(operation, Access::idOf(state, a)));
}
Number apply(Operation operation, const Number& a, const Number& b) {
  if (a.isConstant() && b.isConstant()) return Number(evaluate(operation, a.constant(), b.constant(), 0));
  auto& state = Access::current();
  const Id x = Access::idOf(state, a), y = Access::idOf(state, b);
  return Access::made<Number>(state, state.graph.make(operation, x, y));
}
Condition compare(Operation operation, const Number& a, const Number& b) {
  if (a.isConstant() && b.isConstant())
    return Condition(evaluate(operation, a.constant(), b.constant(), 0) != 0);
  auto& state = Access::current();
  const Id x = Access::idOf(state, a), y = Access::idOf(state, b);
  return Access::made<Condition>(state, state.graph.make(operation, x, y));
}
Condition combine(Operation operation, const Condition& a, const Condition& b) {
  if (a.isConstant() && b.isConstant())
    return Condition(evaluate(operation, a.constant() ? 1 : 0, b.constant() ? 1 : 0, 0) != 0);
  auto& state = Access::current();
  const Id x = Access::idOf(state, a), y = Access::idOf(state, b);
  return Access::made<Condition>(state, state.graph.make(operation, x, y));
}
Number choose(const Condition& condition, const Number& a, const Number& b) {
  if (condition.isConstant()) return condition.constant() ? a : b;
  auto& state = Access::current();
  const Id c = Access::idOf(state, condition), x = Access::idOf(state, a), y = Access::idOf(state, b);
  return Access::made<Number>(state, state.graph.select(c, x, y));
}

Number newTangent() {
  auto& state = Access::current();
  return Access::made<Number>(state, state.graph.leaf(Operation::tangent, state.tangents++));
}

void setDerivative(const Number& x, const std::vector<Term>& terms) {
  if (x.isConstant()) return;
  auto& state = Access::current();
  const Id id = Access::idOf(state, x);
  if (state.graph[id].operation == Operation::datum || state.stated.contains(id)) return;
  std::vector<StatedTerm> stated;
  for (const Term& term : terms) {
    if (term.of.isConstant()) continue;
    const Id coefficient = Access::idOf(state, term.coefficient);
    if (state.graph.isConstant(coefficient, 0)) continue;
    stated.push_back({Access::idOf(state, term.of), coefficient});
  }
  state.stated.emplace(id, std::move(stated));
}

}  // namespace detail

using detail::Access;

void raiseBranch(const Condition& condition) {
  throw mtk::Error(
      "slom.traced-branch",
      "a traced measurement function branches on a computed number" + Access::placeOf(condition) +
          "; write slom.where(condition, a, b), which takes a where the condition holds and b elsewhere",
      "slom::traced");
}

Number data(double value) {
  auto& state = Access::current();
  state.values.push_back(value);
  return Access::made<Number>(state,
                              state.graph.leaf(Operation::datum, static_cast<Id>(state.values.size() - 1)));
}

Recording::Recording() : state_(new State) {
  state_->outer = State::current();
  do {
    state_->number = ++last_number;
  } while (state_->number == 0);
  State::current() = &*state_;
}
Recording::~Recording() { State::current() = state_->outer; }

Recording::Input Recording::variable(const VariableType& type) {
  State& state = *state_;
  state.variables.push_back(type);
  Input input;
  for (const Part& part : type.parts) {
    const std::size_t first = input.coordinates.size(), first_tangent = input.tangent.size();
    for (int i = 0; i < part.coordinates(); ++i) {
      input.coordinates.push_back(
          Access::made<Number>(state, state.graph.leaf(Operation::coordinate, state.coordinates++)));
    }
    for (int i = 0; i < part.dof(); ++i) {
      input.tangent.push_back(detail::newTangent());
      state.unknowns.push_back(Access::idOf(state, input.tangent.back()));
    }
    const Number* const x = input.coordinates.data() + first;
    const Number* const d = input.tangent.data() + first_tangent;
    if (part.kind == Part::Kind::rotation) {  // q (0, d) / 2
      const Number half(0.5), qx = half * x[0], qy = half * x[1], qz = half * x[2], qw = half * x[3];
      detail::setDerivative(x[0], {{d[0], qw}, {d[1], -qz}, {d[2], qy}});
      detail::setDerivative(x[1], {{d[0], qz}, {d[1], qw}, {d[2], -qx}});
      detail::setDerivative(x[2], {{d[0], -qy}, {d[1], qx}, {d[2], qw}});
      detail::setDerivative(x[3], {{d[0], -qx}, {d[1], -qy}, {d[2], -qz}});
    } else if (part.kind == Part::Kind::direction) {  // the axes of mtk::S2
      const Number one(1), sign = select(x[2] < Number(0), Number(-1), one), f = Number(-1) / (sign + x[2]);
      const Number xy = x[0] * x[1] * f;
      detail::setDerivative(x[0], {{d[0], one + sign * x[0] * x[0] * f}, {d[1], xy}});
      detail::setDerivative(x[1], {{d[0], sign * xy}, {d[1], sign + x[1] * x[1] * f}});
      detail::setDerivative(x[2], {{d[0], -sign * x[0]}, {d[1], -x[1]}});
    } else {
      for (int i = 0; i < part.dof(); ++i) detail::setDerivative(x[i], {{d[i], Number(1)}});
    }
  }
  return input;
}

Number Recording::data(double value) { return tape::data(value); }
const std::vector<double>& Recording::values() const { return state_->values; }

void Recording::at(std::string_view file, int line) {
  State* const state = State::current();
  if (state == nullptr) return;
  const std::size_t count = state->places.size();
  if (count == 0 || state->places.back().line != line || state->places.back().file != file)
    state->places.push_back({std::string(file), line});
  state->graph.setPlace(static_cast<std::uint32_t>(state->places.size()));
}

std::uint64_t Recording::fingerprint(const std::vector<Number>& residual) const {
  State& state = *state_;
  std::uint64_t h = 0;
  const auto mix = [&](std::uint64_t x) { h = (std::rotl(h, 23) ^ x) * 0x9E3779B97F4A7C15u; };
  for (Id id = 0; id < state.graph.size(); ++id) {
    const Node& n = state.graph[id];
    mix(static_cast<std::uint64_t>(n.operation));
    mix((std::uint64_t{n.a} << 32) | n.b);
    mix(n.c);
    mix(std::bit_cast<std::uint64_t>(n.value));
  }
  for (const Number& r : residual) mix(Access::idOf(state, r));
  return h;
}

Tape Recording::finish(const std::vector<Number>& residual) {
  State& state = *state_;
  Formula formula;
  formula.variables = state.variables;
  formula.data = static_cast<int>(state.values.size());
  formula.places = state.places;
  for (const Number& r : residual) formula.residual.push_back(Access::idOf(state, r));
  state.graph.setPlace(0);
  formula.jacobian = differentiate(state.graph, state.stated, formula.residual, state.unknowns);
  return Tape(assemble(state.graph, formula));
}

}  // namespace slom::tape
