#!/bin/sh
# Runs the program on two processes and compares what it prints with the page.
cd "@CMAKE_CURRENT_BINARY_DIR@" || exit 1
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1
export OMPI_MCA_btl_vader_single_copy_mechanism=none
"@MPIRUN@" -n 2 ./program > printed || exit 1
diff printed expected
