#define SLOM_EIGEN_INSTANCE template
#include "support/eigen_instances.hpp"
