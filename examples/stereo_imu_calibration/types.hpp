// Lines 1 to 9 of the paper: the types of the calibration problem.
#pragma once

#include <slom/slom.hpp>

typedef MTK::vect<2> vec2; // 2D vector
typedef MTK::vect<3> vec3; // 3D vector
typedef MTK::SO3< > SO3; // 3D Orientation
typedef MTK::trafo<SO3> SE3; // 3D Transform
typedef MTK::Scalar< > Scalar; // Scalar variable
typedef MTK::vect<9> CamIntrinsics; // Camera intrinsics

struct Camera : public CamIntrinsics {
    vec2 sensor2image(const vec3& point) const;
};
