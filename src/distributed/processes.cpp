#include "slom/distributed/processes.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <petsclog.h>
#include <petscsys.h>
#include <utility>

#include "distributed/index.hpp"
#include "mtk/error.hpp"

namespace slom::distributed {

namespace {

bool has_agreed_on_error = false;
int process_of_error = -1;

constexpr std::size_t kChunk = std::size_t{1} << 30;  // bytes; MPI counts them in int

/// Calls f(begin, size) for the chunks of a text.
template <class F>
void forEachChunk(std::size_t size, const F& f) {
  for (std::size_t begin = 0; begin < size; begin += kChunk) f(begin, int(std::min(kChunk, size - begin)));
}

/// Counts a message of `size` bytes in PETSc's log.
void countMessage(std::size_t size, PetscLogDouble& messages, PetscLogDouble& bytes) {
  messages += size > 0 ? 1 : 0;
  bytes += double(size);
}

std::vector<const std::string*> placesOf(const std::vector<std::string>& texts) {
  std::vector<const std::string*> places;
  for (const std::string& text : texts) places.push_back(&text);
  return places;
}

/// Returns the sizes of the texts that each process will send to this one.
std::vector<std::size_t> sizesFrom(const std::vector<const std::string*>& to_each) {
  static_assert(sizeof(std::size_t) == sizeof(std::uint64_t));
  std::vector<std::size_t> sizes, sizes_from(to_each.size());
  for (const std::string* text : to_each) sizes.push_back(text->size());
  MPI_Alltoall(sizes.data(), 1, MPI_UINT64_T, sizes_from.data(), 1, MPI_UINT64_T, PETSC_COMM_WORLD);
  return sizes_from;
}

/// Sends to each process its text and returns the texts from each. `own`: the number of this process.
std::vector<std::string> sendTexts(const std::vector<const std::string*>& to_each,
                                   const std::vector<std::size_t>& sizes_from, int own) {
  constexpr int tag = 50;
  std::vector<std::string> from_each(to_each.size());
  std::vector<MPI_Request> requests;
  for (int p = 0; p < int(to_each.size()); ++p) {
    if (p == own) continue;
    from_each[at(p)].resize(sizes_from[at(p)]);
    countMessage(sizes_from[at(p)], petsc_irecv_ct, petsc_irecv_len);
    forEachChunk(sizes_from[at(p)], [&](std::size_t begin, int size) {
      MPI_Irecv(from_each[at(p)].data() + begin, size, MPI_BYTE, p, tag, PETSC_COMM_WORLD,
                &requests.emplace_back());
    });
  }
  for (int p = 0; p < int(to_each.size()); ++p) {
    if (p == own) continue;
    countMessage(to_each[at(p)]->size(), petsc_isend_ct, petsc_isend_len);
    forEachChunk(to_each[at(p)]->size(), [&](std::size_t begin, int size) {
      MPI_Isend(to_each[at(p)]->data() + begin, size, MPI_BYTE, p, tag, PETSC_COMM_WORLD,
                &requests.emplace_back());
    });
  }
  MPI_Waitall(int(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
  return from_each;
}

/// The error of a process, to be thrown in others.
struct Fault {
  std::string id, sentence, subject;

  std::string bytes() const {
    std::string result;
    for (const std::string* text : {&id, &sentence, &subject})
      result += std::to_string(text->size()) + " " + *text;
    return result;
  }
  explicit Fault(const std::string& bytes) {
    std::size_t at = 0;
    for (std::string* text : {&id, &sentence, &subject}) {
      const std::size_t end = bytes.find(' ', at),
                        size = std::size_t(std::stoull(bytes.substr(at, end - at)));
      *text = bytes.substr(end + 1, size);
      at = end + 1 + size;
    }
  }
  Fault() = default;

  [[noreturn]] void raise() const {
    if (id.empty()) throw std::runtime_error(sentence);
    throw mtk::Error(id, sentence, subject);
  }
};

Fault faultOf(const std::exception_ptr& exception) {
  Fault fault;
  try {
    std::rethrow_exception(exception);
  } catch (const mtk::Error& error) {
    fault.id = error.id();
    fault.sentence = error.sentence();
    fault.subject = error.subject();
  } catch (const std::exception& error) {
    fault.sentence = error.what();
  } catch (...) {
    fault.sentence = "an exception that is no std::exception";
  }
  return fault;
}

}  // namespace

Processes::Processes() {
  PetscBool has_begun = PETSC_FALSE;
  PetscInitialized(&has_begun);
  if (has_begun == PETSC_FALSE) {
    throw mtk::Error("slom.no-session",
                     "there is no slom::distributed::Session; make one at the beginning of main()",
                     "Session");
  }
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank_);
  MPI_Comm_size(PETSC_COMM_WORLD, &size_);
}

double Processes::sum(double x) const {
  std::vector<double> all(at(size_));
  MPI_Allgather(&x, 1, MPI_DOUBLE, all.data(), 1, MPI_DOUBLE, PETSC_COMM_WORLD);
  double sum = 0;
  for (const double part : all) sum += part;
  return sum;
}

double Processes::max(double x) const {
  double largest = x;  // NaN counts as the largest
  std::vector<double> all(at(size_));
  MPI_Allgather(&x, 1, MPI_DOUBLE, all.data(), 1, MPI_DOUBLE, PETSC_COMM_WORLD);
  for (const double part : all) largest = part > largest || part != part ? part : largest;
  return largest;
}

std::vector<std::string> Processes::gather(const std::string& text) const {
  const std::vector<const std::string*> to_each(at(size_), &text);
  std::vector<std::string> all = sendTexts(to_each, sizesFrom(to_each), rank_);
  all[at(rank_)] = text;
  return all;
}

std::vector<std::string> Processes::exchange(std::vector<std::string> to_each) const {
  const std::vector<std::size_t> sizes_from = sizesFrom(placesOf(to_each));
  return exchange(std::move(to_each), sizes_from);
}

std::vector<std::string> Processes::exchange(std::vector<std::string> to_each,
                                             const std::vector<std::size_t>& sizes_from) const {
  std::vector<std::string> all = sendTexts(placesOf(to_each), sizes_from, rank_);
  all[at(rank_)] = std::move(to_each[at(rank_)]);
  return all;
}

std::string Processes::broadcast(const std::string& bytes, int from) const {
  std::uint64_t size = bytes.size();
  MPI_Bcast(&size, 1, MPI_UINT64_T, from, PETSC_COMM_WORLD);
  std::string result = bytes;
  result.resize(size);
  forEachChunk(size, [&](std::size_t begin, int count) {
    MPI_Bcast(result.data() + begin, count, MPI_BYTE, from, PETSC_COMM_WORLD);
  });
  return result;
}

void Processes::wait() const { MPI_Barrier(PETSC_COMM_WORLD); }

void Processes::agreeOn(const std::function<void()>& f) const {
  std::exception_ptr exception;
  try {
    f();
  } catch (...) {
    exception = std::current_exception();
  }
  int first = exception ? rank_ : size_;
  MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT, MPI_MIN, PETSC_COMM_WORLD);
  has_agreed_on_error = first < size_;
  if (!has_agreed_on_error) return;
  process_of_error = first;
  const std::string fault = broadcast(first == rank_ ? faultOf(exception).bytes() : "", first);
  if (first == rank_) std::rethrow_exception(exception);
  Fault(fault).raise();
}

bool Processes::haveAgreedOnError() { return has_agreed_on_error; }
int Processes::processOfError() { return process_of_error; }

void Processes::end(int exit_code) {
  MPI_Abort(PETSC_COMM_WORLD, exit_code);
  std::abort();
}

}  // namespace slom::distributed
