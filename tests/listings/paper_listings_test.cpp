// The listings of "Tutorial on Quick and Easy Model Fitting Using the SLoM Framework", as literally as C++ allows.
// There are three differences from the published text. `scalar` of lines 48-49 is spelled `Scalar` as in line 5. The
// gravity listing (line 38) rotates by the orientation, because an acceleration is a direction, not a point. The camera
// model, data and start values that the paper omits are simulated here. The listings are formatted as published.
// clang-format off
#include <slom/slom.hpp>

#include <gtest/gtest.h>

#include <random>
#include <sstream>

namespace {

using SLOM::Estimator;
using SLOM::VarID;

// Lines 1 to 6.
typedef MTK::vect<2> vec2; // 2D vector
typedef MTK::vect<3> vec3; // 3D vector
typedef MTK::SO3< > SO3; // 3D Orientation
typedef MTK::trafo<SO3> SE3; // 3D Transform
typedef MTK::Scalar< > Scalar; // Scalar variable
typedef MTK::vect<9> CamIntrinsics; // Camera intrinsics

// Lines 7 to 9.
struct Camera : public CamIntrinsics {
    vec2 sensor2image(const vec3& point) const;
};

// Lines 10 to 14.
MTK_BUILD_MANIFOLD(StereoCamera,
((Camera, left))
((Camera, right))
((SE3, left2right))
)

// Lines 15 to 22.
SLOM_BUILD_MEASUREMENT(StereoMeasurement, 4,
((StereoCamera, cam))
((SE3, left2world))
,
((vec3, cornerInWorld))
((vec2, leftMeas))
((vec2, rightMeas))
)

// Lines 23 to 28.
SLOM_IMPLEMENT_MEASUREMENT(StereoMeasurement, ret){
    vec3 cornerInLeft = left2world->inverse() * cornerInWorld;
    vec3 cornerInRight = cam->left2right * cornerInLeft;
    ret << cam->left.sensor2image(cornerInLeft) - leftMeas,
        cam->right.sensor2image(cornerInRight) - rightMeas;
}

// Lines 29 to 36.
SLOM_BUILD_MEASUREMENT(Gravity, 3,
((vec3, acc_bias))
((SE3, left2world))
((SO3, left2imu))
((Scalar, g))
,
((vec3, acc))
)

// Lines 37 to 40.
SLOM_IMPLEMENT_MEASUREMENT(Gravity, ret){
    vec3 acc_world = left2world->orient * left2imu->inverse() * (acc - *acc_bias);
    ret = (acc_world - *g * vec3::UnitZ());
}

// Left out in the paper: fx, fy, cx, cy, k1, k2, p1, p2, k3 as OpenCV has them.
vec2 Camera::sensor2image(const vec3& point) const {
    const Camera& c = *this;
    const double x = point[0] / point[2], y = point[1] / point[2], r2 = x * x + y * y;
    const double radial = 1 + r2 * (c[4] + r2 * (c[5] + r2 * c[8]));
    return vec2(c[0] * (x * radial + 2 * c[6] * x * y + c[7] * (r2 + 2 * x * x)) + c[2],
                c[1] * (y * radial + c[6] * (r2 + 2 * y * y) + 2 * c[7] * x * y) + c[3]);
}

// What the cameras and the IMU would measure, without noise.
struct Truth {
    StereoCamera cam;
    SO3 left2imu = SO3::exp(vec3(1.2, -1.1, 1.3));
    vec3 acc_bias = vec3(0.1, -0.2, 0.05);
    double gravity = 9.81;
    std::vector<SE3> poses;
    std::vector<vec3> calib_points;

    Truth() {
        cam.left << 800, 805, 320, 240, -0.2, 0.1, 1e-3, -1e-3, 0;
        cam.right << 790, 795, 330, 235, -0.18, 0.08, -1e-3, 5e-4, 0;
        cam.left2right = SE3(SO3::exp(vec3(0.01, 0.05, -0.02)), vec3(-0.1, 0.002, 0.003));
        for(int x = 0; x < 9; ++x) for(int y = 0; y < 6; ++y) calib_points.push_back(vec3(0.03 * x - 0.12, 0.03 * y - 0.075, 0));
        std::mt19937 rng(7);
        std::uniform_real_distribution<double> u(-1, 1);
        for(int i = 0; i < 8; ++i){
            // Looks down at the board from about half a metre.
            const SO3 view = SO3::exp(vec3(M_PI, 0, 0)) * SO3::exp(vec3(0.5 * u(rng), 0.5 * u(rng), 3 * u(rng)));
            poses.push_back(SE3(view, view * vec3(0.05 * u(rng), 0.05 * u(rng), -0.5 - 0.1 * u(rng))));
        }
    }
};

TEST(PaperListings, TutorialOfSection2Runs) {
    const Truth truth;
    const int num_images = int(truth.poses.size()), num_points = int(truth.calib_points.size());
    StereoCamera guess = truth.cam;
    guess.left.head<4>() << 780, 780, 310, 250;
    guess.right.head<4>() << 780, 780, 310, 250;
    guess.left.tail<5>().setZero();
    guess.right.tail<5>().setZero();

    Estimator est; // Estimator, responsible for data management & optimization
    std::vector<vec3> calib_points = truth.calib_points; // Known calibration point positions

    // Variables shared by multiple measurements:
    VarID<StereoCamera> cam = est.insertRV(StereoCamera(guess));
    VarID<SO3> left2imu = est.insertRV(SO3(truth.left2imu * SO3::exp(vec3(0.1, 0.1, -0.1))));
    VarID<vec3> acc_bias = est.insertRV(vec3());
    VarID<Scalar> grav = est.insertRV(Scalar(9.81));

    for(int i=0; i<num_images; ++i){
        SE3 pose;
        std::vector<std::pair<vec2, vec2> > point_measurements;
        // collect image points, get an initial guess for the left camera pose
        pose = truth.poses[i];
        for(int j=0; j<num_points; ++j){
            vec3 left = pose.inverse() * calib_points[j];
            point_measurements.push_back(std::make_pair(truth.cam.left.sensor2image(left),
                truth.cam.right.sensor2image(truth.cam.left2right * left)));
        }
        pose.boxplus((Eigen::Matrix<double, 6, 1>() << 0.01, -0.01, 0.02, 0.02, 0.01, -0.02).finished());
        // left2world is only local, since we do not need its optimized value
        VarID<SE3> left2world = est.insertRV(pose);
        for(int j=0; j<num_points; ++j){
            est.insertMeasurement(StereoMeasurement(cam, left2world,
                calib_points[j],
                point_measurements[j].first, point_measurements[j].second));
        }
        //insert gravitation measurement:
        vec3 acc = truth.left2imu * truth.poses[i].orient.inverse() * vec3(0, 0, truth.gravity) + truth.acc_bias;
        double acc_sigma = 1e-3;
        est.insertMeasurement(Gravity(acc_bias, left2world, left2imu, grav, acc),
            SLOM::StandardDeviation(acc_sigma));
    }

    for(int i=0; i<100; ++i){
        est.optimizeStep();
    }
    std::ostringstream out;
    out << "Camera intrinsics " << *cam << "\nleft2imu " << *left2imu
        << "\nGravity " << *grav << "\nAccelerometer Bias " << *acc_bias << "\n";

    EXPECT_LT(est.getRSS(), 1e-12);
    EXPECT_LT(mtk::difference(*cam, truth.cam).norm(), 1e-5);
    EXPECT_LT(mtk::difference(*left2imu, truth.left2imu).norm(), 1e-8);
    EXPECT_NEAR(*grav, truth.gravity, 1e-8);
    EXPECT_LT((*acc_bias - truth.acc_bias).norm(), 1e-8);
    EXPECT_NE(out.str().find("\nGravity 9.81\n"), std::string::npos) << out.str();
    EXPECT_EQ(est.getM(), num_images * (4 * num_points + 3));
    EXPECT_EQ(est.getN(), 24 + 3 + 3 + 1 + 6 * num_images);
}

// Section 3: fixing and releasing, another algorithm.
TEST(PaperListings, Section3Runs) {
    Estimator est;
    VarID<vec3> bias = est.insertRV(vec3(1, 2, 3), false); // do not optimize bias
    VarID<vec3> other = est.insertRV(vec3());
    auto sum = [](const vec3& a, const vec3& b) -> vec3 { return a + b; };
    auto prior = [](const vec3& a) -> vec3 { return a - vec3(4, 4, 4); };
    est.insertMeasurement(sum, bias, other);
    est.insertMeasurement(prior, other);
    est.optimizeStep();
    EXPECT_EQ(*bias, vec3(1, 2, 3));
    est.optimizeRV(bias, true); // "un-fix" bias
    est.optimizeStep(); // call optimizer again
    EXPECT_LT((*bias - vec3(-4, -4, -4)).norm(), 1e-8);

    est.changeAlgorithm(new SLOM::LevenbergMarquardt());
    EXPECT_GE(est.optimizeStep(), 0.0);
}

// Listings 5 and 6 of the appendix.
typedef MTK::trafo<MTK::SO2< > > Pose;

SLOM_BUILD_MEASUREMENT(LM_observation, 2, ((Pose, pose)) ((vec2, landmark)),
    ((vec2, coords ))
)
SLOM_IMPLEMENT_MEASUREMENT(LM_observation, ret) {
  ret = ( pose->inverse() * (*landmark) ) - coords;
}

TEST(PaperListings, Listings5And6Run) {
    Estimator est;
    const Pose truth(MTK::SO2< >(0.5), vec2(1, 2));
    VarID<Pose> poseID = est.insertRV(Pose(), false);
    est.reinitRV(poseID, truth);
    std::vector<VarID<vec2> > landmark;
    const Eigen::Matrix2d information = (Eigen::Matrix2d() << 4, 1, 1, 3).finished();
    for(int id = 0; id < 3; ++id){
        landmark.push_back(est.insertRV(vec2()));
        const vec2 observation = truth.inverse() * vec2(id, 1.0 - id);
        est.insertMeasurement(
            LM_observation( poseID, landmark[id], observation),
            SLOM::InvCovariance(information)
        );
    }
    est.optimizeStep();
    for(int id = 0; id < 3; ++id) EXPECT_LT((*landmark[id] - vec2(id, 1.0 - id)).norm(), 1e-9);
}

// Section 6, the outlook: a plain function is a measurement.
typedef vec3 Var1;
typedef Scalar Var2;
typedef vec2 Dat1;
typedef Eigen::Vector2d VectorNd;

VectorNd measurement(const Var1& v1, const Var2& v2, const Dat1& d1) {
    // do some calculations using v1, v2, ...
    return VectorNd(v1[0] + v2 - d1[0], v1.tail<2>().norm() - d1[1]);
}

TEST(PaperListings, OutlookCompiles) {
    Estimator est;
    VarID<Var1> v1 = est.registerRV(Var1(0, 3, 4)); // register variables
    VarID<Var2> v2 = est.registerRV(Var2()); // ...
    est.registerMeasurement(measurement, v1, v2, Dat1(1, 2));
    EXPECT_NEAR(est.getRSS(), 1 + 9, 1e-12);
}

}  // namespace
