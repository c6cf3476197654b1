/// Eigen's products and triangular solves of large matrices are compiled once for all test programs, optimised, in
/// eigen_instances.cpp. Without that the references that tests compute with matrices would run unoptimised, as test programs are
/// compiled (cmake/SlomQuick.cmake), for three quarters of the time of some. Precompiled headers begin with this one.
#pragma once

#include <Eigen/Dense>

#ifndef SLOM_EIGEN_INSTANCE
#define SLOM_EIGEN_INSTANCE extern template
#endif

// These are inner names of Eigen, as they are in version 3.4; with another one, each program compiles what it needs.
#if EIGEN_WORLD_VERSION == 3 && EIGEN_MAJOR_VERSION == 4
namespace Eigen::internal {

using Kernel = gebp_traits<double, double>;
using Columns = const_blas_data_mapper<double, Index, ColMajor>;
using Rows = const_blas_data_mapper<double, Index, RowMajor>;
using ColumnsOut = blas_data_mapper<double, Index, ColMajor>;

// matrix times matrix
SLOM_EIGEN_INSTANCE struct gebp_kernel<double, double, Index, ColumnsOut, Kernel::mr, Kernel::nr, false,
                                       false>;
SLOM_EIGEN_INSTANCE struct gemm_pack_lhs<double, Index, Columns, Kernel::mr, Kernel::LhsProgress,
                                         Kernel::LhsPacket4Packing, ColMajor>;
SLOM_EIGEN_INSTANCE struct gemm_pack_lhs<double, Index, Rows, Kernel::mr, Kernel::LhsProgress,
                                         Kernel::LhsPacket4Packing, RowMajor>;
SLOM_EIGEN_INSTANCE struct gemm_pack_rhs<double, Index, Columns, Kernel::nr, ColMajor>;
SLOM_EIGEN_INSTANCE struct gemm_pack_rhs<double, Index, Rows, Kernel::nr, RowMajor>;
SLOM_EIGEN_INSTANCE struct gemm_pack_rhs<double, Index, ColumnsOut, Kernel::nr, ColMajor, false, true>;

SLOM_EIGEN_INSTANCE struct general_matrix_matrix_product<Index, double, ColMajor, false, double, ColMajor,
                                                         false, ColMajor, 1>;
SLOM_EIGEN_INSTANCE struct general_matrix_matrix_product<Index, double, ColMajor, false, double, RowMajor,
                                                         false, ColMajor, 1>;
SLOM_EIGEN_INSTANCE struct general_matrix_matrix_product<Index, double, RowMajor, false, double, ColMajor,
                                                         false, ColMajor, 1>;
SLOM_EIGEN_INSTANCE struct general_matrix_matrix_product<Index, double, RowMajor, false, double, RowMajor,
                                                         false, ColMajor, 1>;

// of which one triangle is wanted
SLOM_EIGEN_INSTANCE struct general_matrix_matrix_triangular_product<Index, double, ColMajor, false, double,
                                                                    RowMajor, false, ColMajor, 1, Lower>;
SLOM_EIGEN_INSTANCE struct general_matrix_matrix_triangular_product<Index, double, RowMajor, false, double,
                                                                    ColMajor, false, ColMajor, 1, Lower>;

// matrix times vector
SLOM_EIGEN_INSTANCE struct general_matrix_vector_product<Index, double, Columns, ColMajor, false, double,
                                                         Rows, false>;
SLOM_EIGEN_INSTANCE struct general_matrix_vector_product<Index, double, Columns, ColMajor, false, double,
                                                         Columns, false>;
SLOM_EIGEN_INSTANCE struct general_matrix_vector_product<Index, double, Rows, RowMajor, false, double,
                                                         Columns, false>;
SLOM_EIGEN_INSTANCE struct general_matrix_vector_product<Index, double, Rows, RowMajor, false, double, Rows,
                                                         false, 1>;
SLOM_EIGEN_INSTANCE struct selfadjoint_matrix_vector_product<double, Index, ColMajor, Lower, false, false>;

// triangle times matrix, as in Householder's reflections
SLOM_EIGEN_INSTANCE struct product_triangular_matrix_matrix<double, Index, UnitUpper, true, RowMajor, false,
                                                            ColMajor, false, ColMajor, 1>;
SLOM_EIGEN_INSTANCE struct product_triangular_matrix_matrix<double, Index, UnitLower, true, ColMajor, false,
                                                            ColMajor, false, ColMajor, 1>;
SLOM_EIGEN_INSTANCE struct product_triangular_matrix_matrix<double, Index, Upper, true, RowMajor, false,
                                                            ColMajor, false, ColMajor, 1>;
SLOM_EIGEN_INSTANCE struct product_triangular_matrix_matrix<double, Index, Lower, true, ColMajor, false,
                                                            ColMajor, false, ColMajor, 1>;

// solving with triangles
SLOM_EIGEN_INSTANCE struct triangular_solve_matrix<double, Index, OnTheLeft, UnitLower, false, ColMajor,
                                                   ColMajor, 1>;
SLOM_EIGEN_INSTANCE struct triangular_solve_matrix<double, Index, OnTheLeft, Lower, false, ColMajor, ColMajor,
                                                   1>;
SLOM_EIGEN_INSTANCE struct triangular_solve_matrix<double, Index, OnTheLeft, Upper, false, ColMajor, ColMajor,
                                                   1>;
SLOM_EIGEN_INSTANCE struct triangular_solve_matrix<double, Index, OnTheLeft, Upper, false, RowMajor, ColMajor,
                                                   1>;
SLOM_EIGEN_INSTANCE struct triangular_solve_matrix<double, Index, OnTheRight, Upper, false, RowMajor,
                                                   ColMajor, 1>;

}  // namespace Eigen::internal
#endif
