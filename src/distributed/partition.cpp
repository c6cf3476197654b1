#include "distributed/partition.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <petscmat.h>
#include <tuple>

#include "distributed/index.hpp"
#include "distributed/messages.hpp"
#include "distributed/petsc_error.hpp"

/// Of Scotch, which PETSc loads; null if it is not there. Its header is not needed for more.
extern "C" void SCOTCH_randomReset() __attribute__((weak));

namespace slom::distributed {

namespace {

/// Largest sum of all weights of links or of work: Scotch adds them up in 32 bits.
constexpr double kMostWeight = 1 << 29;

/// Sends both directions of each link to the process of its first vertex, and adds up links of the same vertices.
/// `first`: first vertex of each process, one more for the end.
std::vector<Link> linksOfOwn(const Processes& processes, const std::vector<std::int64_t>& first,
                             const std::vector<Link>& links) {
  std::vector<std::vector<Link>> to_each(at(processes.size()));
  const auto send = [&](const Link& link) {
    const auto next = std::upper_bound(first.begin(), first.end(), link.a);
    to_each[std::size_t(next - first.begin()) - 1].push_back(link);
  };
  for (const Link& link : links) {
    send(link);
    if (link.a != link.b) send({link.b, link.a, link.weight});
  }
  std::vector<Link> own;
  for (const std::vector<Link>& part : exchanged(processes, to_each))
    own.insert(own.end(), part.begin(), part.end());
  std::sort(own.begin(), own.end(),
            [](const Link& x, const Link& y) { return std::tie(x.a, x.b) < std::tie(y.a, y.b); });
  std::size_t last = 0;
  for (std::size_t i = 1; i < own.size(); ++i) {
    if (own[i].a == own[last].a && own[i].b == own[last].b) {
      own[last].weight += own[i].weight;
    } else {
      own[++last] = own[i];
    }
  }
  if (!own.empty()) own.resize(last + 1);
  return own;
}

/// Returns weights from 1 on whose sum over all processes is small enough.
class Weights {
 public:
  Weights(const Processes& processes, double own_sum) {
    factor_ = std::min(1.0, kMostWeight / std::max(1.0, processes.sum(own_sum)));
  }
  PetscInt operator()(std::int64_t weight) const {
    return std::max(PetscInt{1}, PetscInt(std::floor(double(weight) * factor_)));
  }

 private:
  double factor_ = 1;
};

/// The own rows of the graph in PETSc's form. PETSc frees the arrays with the matrix or the partitioning.
struct Rows {
  PetscInt *start = nullptr, *column = nullptr, *weight = nullptr, *work = nullptr;

  Rows(const Processes& processes, std::int64_t first, std::int64_t count, const std::vector<Link>& own) {
    double linked = 0, worked = double(count);
    for (const Link& link : own) (link.a == link.b ? worked : linked) += double(link.weight);
    const Weights weight_of(processes, linked), work_of(processes, worked);
    require(PetscMalloc1(std::size_t(count) + 1, &start));
    require(PetscMalloc1(own.size() + 1, &column));
    require(PetscMalloc1(own.size() + 1, &weight));
    require(PetscMalloc1(std::size_t(count) + 1, &work));
    PetscInt entries = 0;
    std::size_t next = 0;
    for (std::int64_t v = 0; v < count; ++v) {
      start[v] = entries;
      work[v] = 1;
      for (; next < own.size() && own[next].a == first + v; ++next) {
        const Link& link = own[next];
        if (link.a == link.b) {
          work[v] = work_of(link.weight);
        } else {
          column[entries] = PetscInt(link.b);
          weight[entries++] = weight_of(link.weight);
        }
      }
    }
    start[count] = entries;
  }
};

}  // namespace

std::vector<int> partitioned(const Processes& processes, std::int64_t count, const std::vector<Link>& links) {
  if (processes.isAlone()) return std::vector<int>(std::size_t(count), 0);
  std::vector<std::int64_t> first(1, 0);
  for (const std::int64_t other : gathered(processes, std::vector<std::int64_t>{count}))
    first.push_back(first.back() + other);
  if (first.back() == 0) return {};
  const Rows rows(processes, first[at(processes.rank())], count, linksOfOwn(processes, first, links));
  Mat graph = nullptr;
  require(MatCreateMPIAdj(PETSC_COMM_WORLD, PetscInt(count), PetscInt(first.back()), rows.start, rows.column,
                          rows.weight, &graph));
  MatPartitioning partitioning = nullptr;
  require(MatPartitioningCreate(PETSC_COMM_WORLD, &partitioning));
  require(MatPartitioningSetAdjacency(partitioning, graph));
  require(MatPartitioningSetUseEdgeWeights(partitioning, PETSC_TRUE));
  require(MatPartitioningSetVertexWeights(partitioning, rows.work));
  require(MatPartitioningSetNParts(partitioning, processes.size()));
#ifdef PETSC_HAVE_PTSCOTCH
  require(MatPartitioningSetType(partitioning, MATPARTITIONINGPTSCOTCH));
#endif
  require(MatPartitioningSetFromOptions(partitioning));
  if (SCOTCH_randomReset != nullptr) SCOTCH_randomReset();  // an earlier partition does not change this one
  IS process_of = nullptr;
  require(MatPartitioningApply(partitioning, &process_of));
  const PetscInt* processes_of_own = nullptr;
  require(ISGetIndices(process_of, &processes_of_own));
  std::vector<int> result(processes_of_own, processes_of_own + count);
  require(ISRestoreIndices(process_of, &processes_of_own));
  require(ISDestroy(&process_of));
  require(MatPartitioningDestroy(&partitioning));
  require(MatDestroy(&graph));
  return result;
}

}  // namespace slom::distributed
