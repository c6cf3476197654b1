#include "calibration/streams/condensed.hpp"

#include <utility>

#include <Eigen/QR>

#include "calibration/fit/seen_board.hpp"
#include "slom/base/threads.hpp"

namespace slom::calibration {
namespace {

/// Fills the rows of a view into the columns of its variables, and the residuals into the last one.
void fill(const View& view, const SeenBoard& board, Eigen::Index lens, Eigen::Index camera,
          Eigen::Ref<Eigen::MatrixXd> rows) {
  Eigen::Index row = 0;
  for (const Corner& corner : view.corners) {
    const SeenBoard::Rows seen = board.rowsOf(corner.world);
    auto two = rows.middleRows<2>(row);
    two.leftCols<6>() = seen.byLeft2World();
    two.middleCols(lens, seen.seen.by_parameters.cols()) = seen.seen.by_parameters;
    if (camera > 0) two.middleCols<6>(camera) = seen.byLeft2Camera();
    two.rightCols<1>() = seen.pixel() - corner.pixel;
    if (corner.sigma != 1) two /= corner.sigma;
    row += 2;
  }
}

void condense(const std::vector<const View*>& views, const CamerasAt& at, const SE3& left2world,
              CondensedImage& image) {
  Eigen::Index rows = 0, columns = 6;
  for (std::size_t i = 0; i < views.size(); ++i) {
    rows += 2 * Eigen::Index(views[i]->corners.size());
    columns += at.lenses[image.cameras[i]].parameters();
  }
  Eigen::Index lens = 6, camera = columns;
  for (const std::size_t c : image.cameras) columns += c == 0 ? 0 : 6;
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(rows, columns + 1);
  Eigen::Index row = 0;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const std::size_t c = image.cameras[i];
    const Eigen::Index count = 2 * Eigen::Index(views[i]->corners.size());
    fill(*views[i], SeenBoard(at.lenses[c], at.rig.left2camera[c], left2world), lens, c == 0 ? 0 : camera,
         J.middleRows(row, count));
    row += count;
    lens += at.lenses[c].parameters();
    camera += c == 0 ? 0 : 6;
  }
  if (rows > columns) {
    const Eigen::HouseholderQR<Eigen::Ref<Eigen::MatrixXd>> qr(J);  // in place
    J = J.topRows(columns).triangularView<Eigen::Upper>().toDenseMatrix();
  }
  image.R = J.leftCols(columns);
  image.b = J.rightCols<1>();
}

}  // namespace

CamerasAt valuesOf(const Result& cameras) {
  CamerasAt values;
  for (const CameraResult& camera : cameras.cameras) {
    values.lenses.push_back(lensOf(camera));
    values.rig.left2camera.push_back(camera.left2camera);
  }
  for (const ImageResult& image : cameras.images) values.rig.left2world[image.image] = image.left2world;
  return values;
}

CondensedCorners condensed(const Dataset& data, CamerasAt point) {
  CondensedCorners all{std::move(point)};
  struct Work {
    std::vector<const View*> views;
    const SE3* pose;
    CondensedImage* image;
  };
  std::vector<Work> work;
  for (const auto& [image, pose] : all.point.rig.left2world) {
    Work one{{}, &pose, &all.images[image]};
    for (std::size_t c = 0; c < data.cameras.size(); ++c) {
      const View* const view = data.cameras[c].find(image);
      if (!view || view->corners.empty()) continue;
      one.views.push_back(view);
      one.image->cameras.push_back(c);
      all.corners += view->corners.size();
    }
    if (one.views.empty())
      all.images.erase(image);
    else
      work.push_back(std::move(one));
  }
  forEachOnThreads(int(work.size()), [&](int i) {
    const Work& one = work[std::size_t(i)];
    condense(one.views, all.point, *one.pose, *one.image);
  });
  return all;
}

}  // namespace slom::calibration
