// Landmark SLAM in the plane: listings 5 and 6 of the paper as a program. A robot drives round a square twice. It
// measures its own motion and, from each pose, the landmarks nearby. Units: metre, radian.
#include <slom/slom.hpp>

#include <cstdio>
#include <cmath>
#include <vector>

typedef MTK::vect<2> vec2;
typedef MTK::vect<3> vec3;
typedef MTK::trafo<MTK::SO2< > > Pose;

// The next pose as seen from this one.
SLOM_BUILD_MEASUREMENT(Odometry, 3, ((Pose, from)) ((Pose, to)),
    ((Pose, motion))
)
SLOM_IMPLEMENT_MEASUREMENT(Odometry, ret) {
  ret = MTK::difference(from->inverse() * *to, motion);
}

// A landmark in the robot's frame.
SLOM_BUILD_MEASUREMENT(LM_observation, 2, ((Pose, pose)) ((vec2, landmark)),
    ((vec2, coords ))
)
SLOM_IMPLEMENT_MEASUREMENT(LM_observation, ret) {
  ret = ( pose->inverse() * (*landmark) ) - coords;
}

// Reproducible noise with any standard library: sums of uniform numbers from a linear congruential generator.
class Noise {
 public:
  double operator()(double sigma) {
    double sum = -6;
    for (int i = 0; i < 12; ++i) {
      state_ = state_ * 6364136223846793005ull + 1442695040888963407ull;
      sum += static_cast<double>(state_ >> 11) / 9007199254740992.0;
    }
    return sigma * sum;
  }

 private:
  unsigned long long state_ = 1;
};

int main() {
  Noise noise;
  const double step = 1, sigma_step = 0.05, sigma_turn = 0.02, sigma_landmark = 0.1, range = 3;
  std::vector<vec2> true_landmarks;
  for (int i = 0; i < 6; ++i) {
    for (const vec2& side : {vec2(2 * i, -1), vec2(11, 2 * i), vec2(10 - 2 * i, 11), vec2(-1, 10 - 2 * i)}) {
      true_landmarks.push_back(side);
    }
  }

  SLOM::Estimator est;
  Pose truth, guess;
  std::vector<Pose> true_poses(1, truth);
  std::vector<SLOM::VarID<Pose>> poses{est.insertRV(guess, false, "pose0")};  // fixed: where the map begins
  std::vector<SLOM::VarID<vec2>> landmark(true_landmarks.size());
  const Eigen::Matrix2d information = Eigen::Matrix2d::Identity() / (sigma_landmark * sigma_landmark);
  const vec3 sigma(sigma_step, sigma_step, sigma_turn);

  for (std::size_t k = 1; k <= 80; ++k) {
    const Pose motion(MTK::SO2< >(k % 10 == 0 ? M_PI / 2 : 0), vec2(step, 0));
    truth = truth * motion;
    true_poses.push_back(truth);
    const Pose measured = MTK::moved(motion, vec3{noise(sigma_step), noise(sigma_step), noise(sigma_turn)});
    guess = guess * measured;  // dead reckoning gives the start values
    poses.push_back(est.insertRV(guess, "pose" + std::to_string(k)));
    est.insertMeasurement(Odometry(poses[k - 1], poses[k], measured), SLOM::StandardDeviation(sigma));

    for (std::size_t id = 0; id < true_landmarks.size(); ++id) {
      vec2 observation = truth.inverse() * true_landmarks[id];
      if (observation.norm() > range) continue;
      observation += vec2{noise(sigma_landmark), noise(sigma_landmark)};
      if (!landmark[id].isValid()) {  // first sight
        landmark[id] = est.insertRV(vec2(guess * observation), "landmark" + std::to_string(id));
      }
      est.insertMeasurement(
          LM_observation( poses[k], landmark[id], observation),
          SLOM::InvCovariance(information)
      );
    }
  }

  const double drift = (guess.pos - truth.pos).norm();
  const SLOM::Summary summary = est.optimize();
  std::printf("%s after %d iterations: %s\n", summary.converged ? "converged" : "NOT converged", summary.iterations,
              summary.message.c_str());
  std::printf("%d measurements, %d unknowns, chi-square/dof %.2f\n", summary.measurements, summary.unknowns,
              summary.chi2PerDof());
  double worst_pose = 0, worst_landmark = 0;
  for (std::size_t k = 0; k < poses.size(); ++k) worst_pose = std::max(worst_pose, (poses[k]->pos - true_poses[k].pos).norm());
  for (std::size_t i = 0; i < landmark.size(); ++i) {
    worst_landmark = std::max(worst_landmark, (*landmark[i] - true_landmarks[i]).norm());
  }
  std::printf("dead reckoning ends %.2f m from the truth; after the fit no pose is off by more than %.2f m, no landmark by "
              "more than %.2f m\n", drift, worst_pose, worst_landmark);
  const Eigen::VectorXd std_dev = est.standardDeviation(poses.back());
  std::printf("last pose: x %.2f +- %.2f m, y %.2f +- %.2f m\n", poses.back()->pos[0], std_dev[0], poses.back()->pos[1], std_dev[1]);
}
