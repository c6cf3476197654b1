// IMU files of slom calibrate.
#include <slom/calibration.hpp>

#include "fuzz/target.hpp"

SLOM_FUZZ_TARGET(imu) {
  using namespace slom::calibration;
  const MemoryFile file(input);
  ImuData imu;
  if (!accepted([&] { imu = readImu(file.name()); })) return;
  require(!imu.readings.empty(), "no reading");
  for (const ImuReading& reading : imu.readings) require(reading.acc.allFinite(), "a reading is not finite");
}
