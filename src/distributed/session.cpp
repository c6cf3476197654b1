#include "slom/distributed/session.hpp"

#include <chrono>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <petscksp.h>
#include <thread>

#include "distributed/petsc_error.hpp"
#include "mtk/error.hpp"
#include "slom/distributed/processes.hpp"

namespace slom::distributed {

void require(int petsc_code) {
  if (petsc_code == 0) return;
  const char* text = nullptr;
  char* specific = nullptr;
  PetscErrorMessage(petsc_code, &text, &specific);
  throw mtk::Error("slom.petsc", "PETSc failed with code " + std::to_string(petsc_code) +
                                     (text != nullptr ? std::string(" (") + text + ")" : "") +
                                     "; check its options (PETSC_OPTIONS) and the memory of the machine");
}

Session::Session(const std::string& petsc_options) {
  ::setenv("SCOTCH_PTHREAD_NUMBER", "1", 1);  // partitions by several threads differ from run to run
  int has_begun = 0;
  MPI_Initialized(&has_begun);
  if (has_begun == 0) {
    int provided = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &provided);
    owns_mpi_ = true;
  }
  PetscBool petsc_has_begun = PETSC_FALSE;
  PetscInitialized(&petsc_has_begun);
  if (petsc_has_begun == PETSC_FALSE) {
    require(PetscInitializeNoArguments());
    require(PetscPopSignalHandler());
    require(PetscPushErrorHandler(PetscReturnErrorHandler, nullptr));
    owns_petsc_ = true;
  }
  if (!petsc_options.empty()) require(PetscOptionsInsertString(nullptr, petsc_options.c_str()));
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank_);
  MPI_Comm_size(PETSC_COMM_WORLD, &size_);
}

std::vector<std::string> Session::unusedPetscOptions() {
  PetscInt count = 0;
  char **names = nullptr, **values = nullptr;
  require(PetscOptionsLeftGet(nullptr, &count, &names, &values));
  std::vector<std::string> unused;
  for (PetscInt i = 0; i < count; ++i) {
    const std::string value = values[i] == nullptr ? "" : values[i];
    unused.push_back("-" + std::string(names[i]) + (value.empty() ? "" : " " + value));
  }
  require(PetscOptionsLeftRestore(nullptr, &count, &names, &values));
  return unused;
}

int run(const std::function<void(const Session&)>& f) {
  const Session session;
  try {
    f(session);
    return 0;
  } catch (const std::exception& error) {
    const bool is_of_all = Processes::haveAgreedOnError();
    // An error that the processes have not agreed on may be that of all. The first one to end ends them all.
    if (!is_of_all) std::this_thread::sleep_for(std::chrono::milliseconds(300) * session.rank());
    if (!is_of_all || Processes::processOfError() == session.rank())
      std::cerr << std::string(error.what()) + "\n";
    if (!is_of_all && session.size() > 1) Processes::end(1);
    Processes().wait();  // so that no process ends before the sentence is printed
    return 1;
  }
}

Session::~Session() {
  if (std::uncaught_exceptions() > 0 && size_ > 1 && !Processes::haveAgreedOnError()) Processes::end(1);
  if (owns_petsc_) PetscFinalize();
  if (owns_mpi_) MPI_Finalize();
}

}  // namespace slom::distributed
