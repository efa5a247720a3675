# Looks for MPI, which modcal-mpi needs and nothing else. FindMPI ends the configuration where MPI is
# installed by half (Debian's openmpi-bin without libopenmpi-dev: mpicxx is there and names folders that
# are not), so mpicxx has to build a program first.
find_program(MPI_CXX_COMPILER NAMES mpicxx mpic++ mpiicpc mpiCC)
mark_as_advanced(MPI_CXX_COMPILER)
set(mpicxx_works TRUE)
if(MPI_CXX_COMPILER)
  set(mpi_probe ${PROJECT_BINARY_DIR}/generated/mpi_probe)
  file(WRITE ${mpi_probe}.cpp "#include <mpi.h>\nint main() { return MPI_Finalize(); }\n")
  execute_process(COMMAND ${MPI_CXX_COMPILER} ${mpi_probe}.cpp -o ${mpi_probe}
                  RESULT_VARIABLE mpicxx_failure OUTPUT_QUIET ERROR_QUIET)
  if(mpicxx_failure)
    set(mpicxx_works FALSE)
    message(STATUS "modcal-mpi is not built: ${MPI_CXX_COMPILER} builds no program; install the "
                   "headers of MPI (Debian: libopenmpi-dev)")
  endif()
endif()
if(mpicxx_works)
  find_package(MPI QUIET COMPONENTS CXX)
endif()
