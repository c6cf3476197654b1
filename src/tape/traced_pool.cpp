#include "tape/traced_pool.hpp"

#include <algorithm>

namespace slom {

namespace {

/// A base that holds what MeasurementPool refers to, so it must be constructed first.
struct OwnTracedType {
  MeasurementType own_type;
  std::shared_ptr<const TracedKind> kind;
};

MeasurementType typeOfKind(const TracedKind& kind);

class TracedPool final : private OwnTracedType, public MeasurementPool {
 public:
  TracedPool(const std::string& name, const std::string& label, const MeasurementType& type,
             const std::vector<VariableRecord>& table, const ActiveSet& active)
      : OwnTracedType{type, static_cast<const TracedKind*>(type.code)->shared_from_this()},
        MeasurementPool(name, label, own_type, table, active),
        arity_(at(type.arity)),
        columns_of_data_(at(kind->tape.data())) {}

  static MeasurementPool* make(const std::string& name, const std::string& label, const MeasurementType& type,
                               const std::vector<VariableRecord>& table, const ActiveSet& active) {
    return new TracedPool(name, label, type, table, active);
  }

  const double* dataOf(int i) const { return data_.data() + at(i) * columns_of_data_; }

 protected:
  int run(int& i, int last, double* r, double* J) override {
    constexpr int most = 512;
    const tape::Tape& tape = kind->tape;
    while (i < last) {
      const int count = std::min(most, last - i);
      evaluateSome(i, count, r, J);
      r += static_cast<std::ptrdiff_t>(count) * tape.rows();
      if (J != nullptr) J += static_cast<std::ptrdiff_t>(count) * tape.rows() * tape.columns();
      i += count;
    }
    return -1;
  }
  int evaluateOne(int i, int, double* r) override {
    evaluateSome(i, 1, r, nullptr);
    return kind->tape.rows();
  }
  int lengthOf(const void*) const override { return kind->tape.rows(); }
  void push(void* measurement) override {
    const auto& own = *static_cast<TracedMeasurement*>(measurement);
    append(own.variables.data(), own.data.data());
  }
  bool pushCopy(const MeasurementPool& from, int i, const std::vector<AnyVarID>&) override {
    const auto& other = static_cast<const TracedPool&>(from);
    append(other.variables_.data() + at(i) * arity_, other.data_.data() + at(i) * columns_of_data_);
    return true;
  }
  void moveLastTo(int i) override {
    const std::size_t last = at(size()) - 1;
    std::copy_n(variables_.data() + last * arity_, arity_, variables_.data() + at(i) * arity_);
    variables_.erase(variables_.end() - static_cast<std::ptrdiff_t>(arity_), variables_.end());
    std::copy_n(data_.data() + last * columns_of_data_, columns_of_data_,
                data_.data() + at(i) * columns_of_data_);
    data_.resize(last * columns_of_data_);
  }
  VariableArgument& argument(int i, int k) override { return variables_[at(i) * arity_ + at(k)]; }

 private:
  void append(const VariableView* variables, const double* data) {
    const auto reserve = [](auto& v, std::size_t more) {
      if (v.size() + more > v.capacity()) v.reserve(std::max(2 * v.capacity(), v.size() + more));
    };
    reserve(variables_, arity_);
    reserve(data_, columns_of_data_);
    variables_.insert(variables_.end(), variables, variables + arity_);
    data_.insert(data_.end(), data, data + columns_of_data_);
  }

  void evaluateSome(int first, int count, double* r, double* J) const {
    static thread_local std::vector<const double*> pointers;
    static thread_local std::vector<double> copies;
    pointers.resize(at(count) * arity_);
    copies.resize(at(count) * at(kind->tape.coordinates()));
    const VariableView* variable = variables_.data() + at(first) * arity_;
    double* copy = copies.data();
    std::size_t next = 0;
    for (int i = 0; i < count; ++i) {
      for (std::size_t k = 0; k < arity_; ++k, ++variable) {
        const auto* const value = static_cast<const std::byte*>(variable->pointer());
        const tape::Layout& layout = kind->layouts[k];
        const auto numberAt = [&](std::uint32_t place) {
          return reinterpret_cast<const double*>(value + place);
        };
        if (kind->is_contiguous[k] != 0) {
          pointers[next++] = layout.empty() ? copy : numberAt(layout.front());
        } else {
          pointers[next++] = copy;
          for (const std::uint32_t place : layout) *copy++ = *numberAt(place);
        }
      }
    }
    kind->tape.evaluate(count, {pointers.data(), dataOf(first)}, r, J);
  }

  std::size_t arity_, columns_of_data_;
  std::vector<VariableView> variables_;
  std::vector<double> data_;
};

MeasurementType typeOfKind(const TracedKind& kind) {
  MeasurementType type{&typeid(TracedMeasurement),
                       static_cast<int>(kind.dof.size()),
                       kind.tape.rows(),
                       kind.dof.data(),
                       DerivativeSource::exact,
                       nullptr,
                       [] { return std::string("traced"); },
                       &TracedPool::make};
  type.code = &kind;
  return type;
}

}  // namespace

const TracedKind* tracedKindOf(const MeasurementPool& pool) {
  return *pool.type().id == typeid(TracedMeasurement) ? static_cast<const TracedKind*>(pool.type().code)
                                                      : nullptr;
}

const double* tracedDataOf(const MeasurementPool& pool, int i) {
  return static_cast<const TracedPool&>(pool).dataOf(i);
}

MeasID<TracedMeasurement> insertTraced(Problem& problem, TracedMeasurement& measurement,
                                       const NoiseView& noise, std::string_view label, const Loss& loss) {
  std::vector<VariableArgument*> arguments;
  for (VariableView& variable : measurement.variables) arguments.push_back(&variable);
  return problem.insertOfType(typeOfKind(*measurement.kind), measurement, arguments.data(), noise, label,
                              loss);
}

}  // namespace slom
