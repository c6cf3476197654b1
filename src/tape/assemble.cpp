#include "tape/assemble.hpp"

#include <algorithm>
#include <bit>
#include <unordered_map>
#include <unordered_set>

#include "mtk/error.hpp"
#include "tape/instructions.hpp"

namespace slom::tape {

namespace {

/// An instruction on values: nodes of the graph, or intermediate sums with higher numbers.
struct Step {
  Kind kind = Kind::copy;
  Id to = 0;
  std::vector<Id> from;  // second results included
  std::uint32_t place = 0;
};

struct Term {
  bool minus = false, is_product = false;
  Id a = 0, b = 0;
};

/// Returns the instruction that adds products and, if there is one, a single term. It subtracts the last `minus`
/// products.
Kind kindOfSum(int products, int minus, bool has_single, bool single_minus) {
  constexpr Kind plain[3][4] = {{Kind::p, Kind::m, Kind::m, Kind::m},
                                {Kind::pp, Kind::pm, Kind::mm, Kind::mm},
                                {Kind::ppp, Kind::ppm, Kind::pmm, Kind::mmm}};
  constexpr Kind with_plus[3][4] = {{Kind::p_sp, Kind::m_sp, Kind::m_sp, Kind::m_sp},
                                    {Kind::pp_sp, Kind::pm_sp, Kind::mm_sp, Kind::mm_sp},
                                    {Kind::ppp_sp, Kind::ppm_sp, Kind::pmm_sp, Kind::mmm_sp}};
  constexpr Kind with_minus[3][4] = {{Kind::p_sm, Kind::m_sm, Kind::m_sm, Kind::m_sm},
                                     {Kind::pp_sm, Kind::pm_sm, Kind::mm_sm, Kind::mm_sm},
                                     {Kind::ppp_sm, Kind::ppm_sm, Kind::pmm_sm, Kind::mmm_sm}};
  return (!has_single ? plain : single_minus ? with_minus : with_plus)[products - 1][minus];
}

Kind kindOf(Operation operation) {
  switch (operation) {
#define SLOM_TAPE_CASE(name) \
  case Operation::name:      \
    return Kind::name;
    SLOM_TAPE_CASE(divide)
    SLOM_TAPE_CASE(reciprocal)
    SLOM_TAPE_CASE(scale)
    SLOM_TAPE_CASE(inverse_arc)
    SLOM_TAPE_CASE(sign)
    SLOM_TAPE_CASE(abs)
    SLOM_TAPE_CASE(floor)
    SLOM_TAPE_CASE(wrap)
    SLOM_TAPE_CASE(sqrt)
    SLOM_TAPE_CASE(sin)
    SLOM_TAPE_CASE(cos)
    SLOM_TAPE_CASE(tan)
    SLOM_TAPE_CASE(asin)
    SLOM_TAPE_CASE(acos)
    SLOM_TAPE_CASE(atan)
    SLOM_TAPE_CASE(sinh)
    SLOM_TAPE_CASE(cosh)
    SLOM_TAPE_CASE(tanh)
    SLOM_TAPE_CASE(asinh)
    SLOM_TAPE_CASE(acosh)
    SLOM_TAPE_CASE(atanh)
    SLOM_TAPE_CASE(exp)
    SLOM_TAPE_CASE(expm1)
    SLOM_TAPE_CASE(log)
    SLOM_TAPE_CASE(log1p)
    SLOM_TAPE_CASE(cbrt)
    SLOM_TAPE_CASE(erf)
    SLOM_TAPE_CASE(erfc)
    SLOM_TAPE_CASE(atan2)
    SLOM_TAPE_CASE(hypot)
    SLOM_TAPE_CASE(pow)
    SLOM_TAPE_CASE(less)
    SLOM_TAPE_CASE(less_equal)
    SLOM_TAPE_CASE(equal)
    SLOM_TAPE_CASE(both)
    SLOM_TAPE_CASE(either)
    SLOM_TAPE_CASE(opposite)
    SLOM_TAPE_CASE(select)
#undef SLOM_TAPE_CASE
    default:
      return Kind::copy;
  }
}

/// Chooses the instructions that compute the outputs.
class Selection {
 public:
  Selection(const Graph& graph, const std::vector<Id>& outputs)
      : graph_(graph), next_(graph.size()), uses_(usesOf(graph, outputs)) {
    listSines();
    for (const Id id : outputs) visit(id);
  }
  const std::vector<Step>& steps() const { return steps_; }

 private:
  bool isLeaf(Id id) const { return operandsOf(graph_[id].operation) == 0; }
  bool isSum(Id id) const {
    const Operation operation = graph_[id].operation;
    return operation == Operation::add || operation == Operation::subtract ||
           operation == Operation::multiply || operation == Operation::negate;
  }

  /// Returns the node as a sum. Takes a term apart, too, if nothing else needs it.
  std::vector<Term> termsOf(Id root) const {
    std::vector<Term> terms;
    std::vector<std::pair<Id, bool>> pending{{root, false}};
    while (!pending.empty()) {
      const auto [id, minus] = pending.back();
      pending.pop_back();
      const Node& n = graph_[id];
      const bool is_own = id == root || uses_[id] == 1;
      if (n.operation == Operation::negate) {
        pending.push_back({n.a, !minus});
      } else if (is_own && n.operation == Operation::multiply) {
        terms.push_back({minus, true, n.a, n.b});
      } else if (is_own && (n.operation == Operation::add || n.operation == Operation::subtract)) {
        pending.push_back({n.b, minus != (n.operation == Operation::subtract)});
        pending.push_back({n.a, minus});
      } else {
        terms.push_back({minus, false, id, 0});
      }
    }
    return terms;
  }

  /// Makes the steps for a node, after those for its operands.
  void visit(Id root) {
    std::vector<Id> pending{root};
    while (!pending.empty()) {
      const Id id = pending.back();
      if (isLeaf(id) || made_.contains(id)) {
        pending.pop_back();
        continue;
      }
      const std::size_t before = pending.size();
      const auto need = [&](Id operand) {
        if (!isLeaf(operand) && !made_.contains(operand)) pending.push_back(operand);
      };
      std::vector<Term> terms;
      const Node& n = graph_[id];
      if (isSum(id)) {
        terms = termsOf(id);
        for (auto term = terms.rbegin(); term != terms.rend(); ++term) {
          if (term->is_product) need(term->b);
          need(term->a);
        }
      } else {
        const int count = operandsOf(n.operation);
        if (count > 2) need(n.c);
        if (count > 1) need(n.b);
        need(n.a);
      }
      if (pending.size() > before) continue;
      pending.pop_back();
      if (isSum(id)) {
        makeSum(id, terms);
      } else {
        makeOther(id, n);
      }
    }
  }

  void makeOther(Id id, const Node& n) {
    if (n.operation == Operation::sin || n.operation == Operation::cos) {
      const auto& twins = n.operation == Operation::sin ? cosines_ : sines_;
      const auto twin = twins.find(n.a);
      if (twin != twins.end()) {
        const bool is_sine = n.operation == Operation::sin;
        steps_.push_back(
            {Kind::sin_cos, is_sine ? id : twin->second, {n.a, is_sine ? twin->second : id}, n.place});
        made_.insert(id);
        made_.insert(twin->second);
        return;
      }
    }
    std::vector<Id> from{n.a};
    const int count = operandsOf(n.operation);
    if (count > 1) from.push_back(n.b);
    if (count > 2) from.push_back(n.c);
    steps_.push_back({kindOf(n.operation), id, from, n.place});
    made_.insert(id);
  }

  void makeSum(Id id, const std::vector<Term>& terms) {
    std::vector<Term> products, singles;
    for (const Term& term : terms) (term.is_product ? products : singles).push_back(term);
    const std::uint32_t place = graph_[id].place;
    while (true) {
      const std::size_t taken = std::min<std::size_t>(3, products.size());
      std::vector<Term> own(products.begin(), products.begin() + static_cast<std::ptrdiff_t>(taken));
      products.erase(products.begin(), products.begin() + static_cast<std::ptrdiff_t>(taken));
      std::stable_partition(own.begin(), own.end(), [](const Term& term) { return !term.minus; });
      const int minus =
          static_cast<int>(std::count_if(own.begin(), own.end(), [](const Term& t) { return t.minus; }));
      Step step;
      step.place = place;
      for (const Term& term : own) step.from.insert(step.from.end(), {term.a, term.b});
      if (taken > 0) {
        const bool has_single = !singles.empty();
        step.kind = kindOfSum(static_cast<int>(taken), minus, has_single, has_single && singles[0].minus);
        if (has_single) {
          step.from.push_back(singles[0].a);
          singles.erase(singles.begin());
        }
      } else if (singles.size() == 1) {
        step.kind = singles[0].minus ? Kind::negate : Kind::copy;
        step.from = {singles[0].a};
        singles.clear();
      } else {
        const Term first = singles[0], second = singles[1];
        if (first.minus == second.minus) {
          step.kind = first.minus ? Kind::negated_sum : Kind::add;
          step.from = {first.a, second.a};
        } else {
          step.kind = Kind::subtract;
          step.from = first.minus ? std::vector<Id>{second.a, first.a} : std::vector<Id>{first.a, second.a};
        }
        singles.erase(singles.begin(), singles.begin() + 2);
      }
      const bool is_last = products.empty() && singles.empty();
      step.to = is_last ? id : next_++;
      if (!is_last) singles.insert(singles.begin(), {false, false, step.to, 0});
      steps_.push_back(std::move(step));
      if (is_last) break;
    }
    made_.insert(id);
  }

  /// Lists the sines and cosines of the formula, so that sine and cosine of one angle are made together.
  void listSines() {
    for (Id id = 0; id < graph_.size(); ++id) {
      if (uses_[id] == 0) continue;
      const Node& n = graph_[id];
      if (n.operation == Operation::sin) sines_[n.a] = id;
      if (n.operation == Operation::cos) cosines_[n.a] = id;
    }
  }

  const Graph& graph_;
  Id next_;
  std::vector<int> uses_;
  std::unordered_set<Id> made_;
  std::unordered_map<Id, Id> sines_, cosines_;  // by angle
  std::vector<Step> steps_;
};

/// Gives registers to values. Those of intermediate results are reused.
class Registers {
 public:
  Registers(const Graph& graph, int first_constant, const std::vector<double>& constants, int first_output,
            const std::vector<Id>& outputs, int coordinates)
      : graph_(graph), coordinates_(coordinates) {
    for (std::size_t i = 0; i < constants.size(); ++i)
      constant_[std::bit_cast<std::uint64_t>(constants[i])] = first_constant + static_cast<int>(i);
    for (std::size_t i = 0; i < outputs.size(); ++i)
      output_.try_emplace(outputs[i], first_output + static_cast<int>(i));
    next_ = first_output + static_cast<int>(outputs.size());
  }

  std::vector<Instruction> translate(const std::vector<Step>& steps) {
    std::unordered_map<Id, std::size_t> last_use;
    for (std::size_t i = 0; i < steps.size(); ++i) {
      for (const Id id : steps[i].from) last_use[id] = i;
      last_use.try_emplace(steps[i].to, i);
    }
    std::vector<Instruction> result;
    for (std::size_t i = 0; i < steps.size(); ++i) {
      const Step& step = steps[i];
      Instruction instruction;
      instruction.kind = static_cast<std::uint16_t>(step.kind);
      const std::size_t inputs = step.from.size() - (hasTwoResults(step.kind) ? 1 : 0);
      for (std::size_t k = 0; k < inputs; ++k) instruction.from[k] = narrow(registerOf(step.from[k]));
      for (std::size_t k = 0; k < inputs; ++k) {
        if (last_use.at(step.from[k]) == i) release(step.from[k]);
      }
      instruction.to = narrow(take(step.to));
      if (hasTwoResults(step.kind)) instruction.from[1] = narrow(take(step.from[1]));
      for (const Id id : {step.to, step.from.back()}) {
        if (last_use.at(id) == i && own_.contains(id)) release(id);
      }
      result.push_back(instruction);
    }
    return result;
  }
  int count() const { return next_; }
  int registerOf(Id id) const {
    if (id < graph_.size()) {
      const Node& n = graph_[id];
      if (n.operation == Operation::coordinate) return static_cast<int>(n.a);
      if (n.operation == Operation::datum) return coordinates_ + static_cast<int>(n.a);
      if (n.operation == Operation::constant) return constant_.at(std::bit_cast<std::uint64_t>(n.value));
    }
    if (const auto found = output_.find(id); found != output_.end()) return found->second;
    return own_.at(id);
  }

 private:
  static std::uint16_t narrow(int i) {
    if (i >= kMostRegisters) {
      throw mtk::Error(
          "slom.traced-too-long",
          "a traced measurement function needs more than " + std::to_string(kMostRegisters) +
              " numbers at once; split the measurement, or pass the function without slom::traced",
          "slom::traced");
    }
    return static_cast<std::uint16_t>(i);
  }
  int take(Id id) {
    if (const auto found = output_.find(id); found != output_.end()) return found->second;
    int own = next_;
    if (free_.empty()) {
      ++next_;
    } else {
      own = free_.back();
      free_.pop_back();
    }
    return own_[id] = own;
  }
  void release(Id id) {
    const auto found = own_.find(id);
    if (found == own_.end()) return;
    free_.push_back(found->second);
    own_.erase(found);
  }

  const Graph& graph_;
  int coordinates_, next_ = 0;
  std::unordered_map<std::uint64_t, int> constant_;  // by bits, because NaN is one, too
  std::unordered_map<Id, int> output_, own_;
  std::vector<int> free_;
};

}  // namespace

Code assemble(const Graph& graph, const Formula& formula) {
  Code code;
  code.variables = formula.variables;
  code.data = formula.data;
  code.rows = static_cast<int>(formula.residual.size());
  code.places = formula.places;

  std::vector<Id> computed;
  for (const Id id : formula.jacobian) {
    if (!graph.isConstant(id)) computed.push_back(id);
  }
  std::vector<Id> all = formula.residual;
  all.insert(all.end(), computed.begin(), computed.end());
  const std::vector<Step> residual = Selection(graph, formula.residual).steps(),
                          both = Selection(graph, all).steps();

  const auto addConstant = [&](Id id) {
    if (id >= graph.size() || !graph.isConstant(id)) return;
    const double value = graph[id].value;
    const auto is_same = [&](double x) {
      return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(value);
    };
    if (std::none_of(code.constants.begin(), code.constants.end(), is_same)) code.constants.push_back(value);
  };
  for (const Step& step : both) {
    for (const Id id : step.from) addConstant(id);
  }
  for (const Step& step : residual) {
    for (const Id id : step.from) addConstant(id);
  }
  for (const Id id : formula.residual) addConstant(id);
  const int coordinates = code.coordinates(), first_constant = coordinates + code.data;
  const int first_output = first_constant + static_cast<int>(code.constants.size());

  const auto translated = [&](const std::vector<Step>& steps, const std::vector<Id>& outputs) {
    Registers registers(graph, first_constant, code.constants, first_output, all, coordinates);
    std::vector<Instruction> instructions = registers.translate(steps);
    for (std::size_t i = 0; i < outputs.size(); ++i) {  // inputs, constants and repeated numbers as outputs
      const int to = first_output + static_cast<int>(i), from = registers.registerOf(outputs[i]);
      if (from == to) continue;
      Instruction copy;
      copy.kind = static_cast<std::uint16_t>(Kind::copy);
      copy.to = static_cast<std::uint16_t>(to);
      copy.from[0] = static_cast<std::uint16_t>(from);
      instructions.push_back(copy);
    }
    code.registers = std::max(code.registers, registers.count());
    return instructions;
  };
  code.residual = translated(residual, formula.residual);
  code.linearization = translated(both, all);
  for (const Step& step : both) code.place_of.push_back(step.place);
  code.place_of.resize(code.linearization.size(), 0);

  int next = first_output + code.rows;
  for (const Id id : formula.jacobian) {
    code.entry_register.push_back(graph.isConstant(id) ? -1 : next++);
    code.entry_constant.push_back(graph.isConstant(id) ? graph[id].value : 0);
  }
  return code;
}

}  // namespace slom::tape
