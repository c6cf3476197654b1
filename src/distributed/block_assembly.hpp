/// BlockAssembly: the blocks of a symmetric matrix that all processes add to, summed at the owners of its rows.
#pragma once

#include <cstdint>
#include <vector>

#include "slom/distributed/processes.hpp"

namespace slom::distributed {

/// Blocks are sent to the owners of their rows and added there in the order of the processes, so sums have the same
/// bits in every run. Rows and columns are numbered across all processes, those of a process one after another.
class BlockAssembly {
 public:
  /// A block of this process: its first row and column, its size, and the processes that own these rows and columns.
  struct Block {
    std::int64_t row = 0, column = 0;
    int rows = 0, columns = 0;
    int row_owner = 0, column_owner = 0;
  };
  /// Plans the sums of blocks that will come in this order. Blocks off the diagonal count for both triangles.
  void plan(const Processes& processes, const std::vector<Block>& blocks);

  /// Begins with zeros; then add() takes the values of each block in the planned order, column-major.
  void begin();
  void add(const double* values);
  /// Exchanges the sums, in all processes.
  void finish(const Processes& processes);

  /// A block of the own rows, whole.
  struct Entry {
    std::int64_t row = 0, column = 0;
    int rows = 0, columns = 0;
    std::size_t start = 0;  ///< first of its values, row-major
  };
  /// Returns the blocks by row, then column.
  const std::vector<Entry>& entries() const { return entries_; }
  const double* values(const Entry& entry) const { return values_.data() + entry.start; }
  double* values(const Entry& entry) { return values_.data() + entry.start; }

 private:
  /// A block that goes to a process.
  struct Head {
    std::int64_t row, column;
    int rows, columns;
  };
  static constexpr std::size_t kNowhere = ~std::size_t{0};
  /// Destinations of a planned block: as it is, and transposed.
  struct Route {
    int size = 0, rows = 0, columns = 0;
    std::size_t as_is = kNowhere, transposed = kNowhere;  ///< first values of own entries
    int send_as_is = -1, send_transposed = -1;            ///< processes
  };
  std::size_t entryOf(const Head& head) const;
  static void addTo(double* sum, const double* values, const Route& route, bool is_transposed);

  std::vector<Entry> entries_;
  std::vector<double> values_;
  std::vector<Route> routes_;
  std::size_t next_ = 0;
  std::vector<std::vector<double>> outgoing_;  // by process
  std::vector<std::vector<std::pair<std::size_t, int>>>
      incoming_;  // by process: start and size of each block
};

}  // namespace slom::distributed
