// Orientation from gyroscope, accelerometer and magnetometer, on recorded data with optical truth.
//   data   ../shared/data/attitude (BROAD, trial 06): readings at 286 Hz, 190 s, up to 16 rad/s
// Units: second, radian, metre; the field in microtesla.
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include <slom/filter.hpp>
#include <slom/io/bal.hpp>

/// Returns the rows of a file of numbers compressed by bzip2, without the header line.
std::vector<std::vector<double>> readCsv(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  std::istringstream text(
      slom::io::bzip2Decompressed(file, std::string(std::istreambuf_iterator<char>(in), {})));
  std::vector<std::vector<double>> rows;
  std::string line;
  std::getline(text, line);
  while (std::getline(text, line)) {
    std::istringstream numbers(line);
    rows.emplace_back();
    for (std::string number; std::getline(numbers, number, ',');) rows.back().push_back(std::stod(number));
  }
  return rows;
}

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: example_attitude_filter FILE, a trial of BROAD as csv.bz2\n");
    return 2;
  }
  const auto rows = readCsv(argv[1]);
  const auto vector = [](const std::vector<double>& row, std::size_t first) {
    return mtk::vect<3>(row[first], row[first + 1], row[first + 2]);
  };

  slom::filter::AttitudeFilter<> attitude;
  double square = 0;
  int count = 0;
  for (const auto& row : rows) {
    const slom::FilterStatus status =
        attitude.step(vector(row, 1), vector(row, 4), vector(row, 7), 1 / 285.714);
    if (status != slom::FilterStatus::done) std::printf("%.3f s: %s\n", row[0], toString(status));
    const bool is_moving = row[17] > 0, has_truth = !std::isnan(row[10]);
    if (!is_moving || !has_truth) continue;
    const mtk::SO3<> truth(row[10], row[11], row[12], row[13]);
    const auto vertical = [](const mtk::SO3<>& R) { return R.inverse() * mtk::vect<3>(0, 0, 1); };
    const double cosine = vertical(truth).dot(vertical(attitude.orientation()));
    square += std::pow(std::acos(std::fmin(1, cosine)), 2);
    ++count;
  }
  const auto sigma = attitude.filter().standardDeviations();
  const auto& bias = attitude.filter().state().gyro_bias;
  std::printf("%d samples in motion: RMS error of the inclination %.2f degrees\n", count,
              std::sqrt(square / count) * 180 / M_PI);
  std::printf("gyroscope bias %.4f %.4f %.4f rad/s, +- %.4f %.4f %.4f\n", bias[0], bias[1], bias[2], sigma[3],
              sigma[4], sigma[5]);
}
