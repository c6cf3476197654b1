// The paper's worked example: calibrates a stereo camera and an IMU from images of a level checkerboard. The code
// follows section 2 of "Tutorial on Quick and Easy Model Fitting Using the SLoM Framework", with the same names and line
// numbers. Lines 1 to 9 of the paper are in types.hpp. The camera model is in camera.cpp, input and rough start values
// are in data.cpp. Line 38 uses only the orientation to rotate the acceleration: a translation must not move a direction.
#include <iostream>

#include "data.hpp"

using SLOM::Estimator;
using SLOM::VarID;

MTK_BUILD_MANIFOLD(StereoCamera,
((Camera, left))
((Camera, right))
((SE3, left2right))
)

SLOM_BUILD_MEASUREMENT(StereoMeasurement, 4,
((StereoCamera, cam))
((SE3, left2world))
,
((vec3, cornerInWorld))
((vec2, leftMeas))
((vec2, rightMeas))
)

SLOM_IMPLEMENT_MEASUREMENT(StereoMeasurement, ret){
    vec3 cornerInLeft = left2world->inverse() * cornerInWorld;
    vec3 cornerInRight = cam->left2right * cornerInLeft;
    ret << cam->left.sensor2image(cornerInLeft) - leftMeas,
        cam->right.sensor2image(cornerInRight) - rightMeas;
}

SLOM_BUILD_MEASUREMENT(Gravity, 3,
((vec3, acc_bias))
((SE3, left2world))
((SO3, left2imu))
((Scalar, g))
,
((vec3, acc))
)

SLOM_IMPLEMENT_MEASUREMENT(Gravity, ret){
    vec3 acc_world = left2world->orient * left2imu->inverse() * (acc - *acc_bias);
    ret = (acc_world - *g * vec3::UnitZ());
}

int main(){
    const std::vector<Image> images = readImages(SLOM_DATA_DIR "/simulated_stereo_imu");
    const SE3 right2world = guessPose(images[0], true);

    Estimator est; // Estimator, responsible for data management & optimization
    // Variables shared by multiple measurements:
    VarID<StereoCamera> cam = est.insertRV(StereoCamera(guessCamera(), guessCamera(),
        right2world.inverse() * guessPose(images[0])));
    VarID<SO3> left2imu = est.insertRV(guessImuRotation(images));
    VarID<vec3> acc_bias = est.insertRV(vec3());
    VarID<Scalar> grav = est.insertRV(Scalar(9.81));

    double pixel_sigma = 0.25, acc_sigma = 0.05;
    for(const Image& image : images){
        // left2world is only local, since we do not need its optimized value
        VarID<SE3> left2world = est.insertRV(guessPose(image));
        for(const StereoCorner& corner : image.corners){
            est.insertMeasurement(StereoMeasurement(cam, left2world,
                corner.world, corner.left, corner.right), SLOM::StandardDeviation(pixel_sigma));
        }
        if(image.has_acc) //insert gravitation measurement:
            est.insertMeasurement(Gravity(acc_bias, left2world, left2imu, grav, image.acc),
                SLOM::StandardDeviation(acc_sigma));
    }

    for(int i=0; i<100; ++i){
        est.optimizeStep();
    }
    std::cout.precision(4);
    std::cout << "Camera intrinsics " << *cam << "\nleft2imu " << *left2imu
        << "\nGravity " << *grav << "\nAccelerometer Bias " << *acc_bias << "\n";
    std::cout << "Standard deviations of gravity " << est.standardDeviation(grav)
        << ", bias " << est.standardDeviation(acc_bias).transpose() << "\nRMS of the whitened residuals " << est.getRMS() << "\n";
}
