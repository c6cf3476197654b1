#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>

#include "io/fault.hpp"
#include "io/g2o/line_forms.hpp"
#include "io/g2o/raw_graph.hpp"
#include "io/g2o/values.hpp"
#include "slom/io/container.hpp"
#include "slom/io/g2o.hpp"
#include "slom/io/number.hpp"

namespace slom::io {

namespace g2o {

namespace {

/// Kind of lines that begin with `name`. `form` shows an example with `words` words after the tag.
template <class Pose>
struct Tag {
  std::string_view name;
  int words;
  const char* form;
  void (*read)(RawGraph<Pose>& raw, Lines& line);
};

void nothing(Lines&) {}

template <auto ReadPose, class Pose>
void readPoseVertex(RawGraph<Pose>& raw, Lines& line) {
  raw.readVertex(raw.graph.poses, line, ReadPose);
}
template <class Pose>
void readLandmarkVertex(RawGraph<Pose>& raw, Lines& line) {
  raw.readVertex(raw.graph.landmarks, line, readPoint<dim<Pose>>);
}
template <auto ReadPose, auto ReadInformation, class Pose>
void readPoseEdge(RawGraph<Pose>& raw, Lines& line) {
  raw.readEdge(raw.graph.edges, raw.edge_ends, line, ReadPose, ReadInformation, nothing);
}
template <class Pose>
void readSighting(RawGraph<Pose>& raw, Lines& line) {
  raw.readEdge(raw.graph.sightings, raw.sighting_ends, line, readPoint<dim<Pose>>, readInformation<dim<Pose>>,
               [&](Lines& rest) {
                 if (dim<Pose> == 3) raw.sighting_sensors.push_back(rest.id());
               });
}
void readBearing(RawGraph<Pose2>& raw, Lines& line) {
  raw.readEdge(
      raw.graph.bearings, raw.bearing_ends, line, [](Lines& rest) { return mtk::SO2<>(rest.number()); },
      readInformation<1>, nothing);
}

/// Reads the pose of a sensor on the robot.
void readSensor(RawGraph<Pose3>& raw, Lines& line) {
  Sensor<Pose3>& sensor = raw.graph.sensors.emplace_back();
  sensor.line = line.lineNumber();
  sensor.id = line.id();
  sensor.offset = readQuaternionPose(line);
  line.finish();
}

template <auto ReadPose, class Pose>
void readPosePrior(RawGraph<Pose>& raw, Lines& line) {
  PosePrior<Pose>& prior = raw.graph.pose_priors.emplace_back();
  PriorOf& of = raw.pose_priors_of.emplace_back();
  prior.line = line.lineNumber();
  of.pose = line.id();
  if (dim<Pose> == 3) of.sensor = line.id();
  prior.measured = ReadPose(line);
  prior.information = readInformation<dof<Pose>>(line);
  line.finish();
}
void readPositionPrior(RawGraph<Pose2>& raw, Lines& line) {
  PositionPrior<Pose2>& prior = raw.graph.position_priors.emplace_back();
  prior.line = line.lineNumber();
  raw.position_priors_of.push_back({line.id(), 0});
  prior.measured = readPoint<2>(line);
  prior.information = readInformation<2>(line);
  line.finish();
}

constexpr std::array<Tag<Pose2>, 10> plane_tags{{
    {"EDGE_SE2", 11, "EDGE_SE2 i j x y theta I11 I12 I13 I22 I23 I33",
     readPoseEdge<readPose2, readInformation<3>>},
    {"VERTEX_SE2", 4, "VERTEX_SE2 i x y theta", readPoseVertex<readPose2>},
    {"EDGE_SE2_XY", 7, "EDGE_SE2_XY i j x y I11 I12 I22", readSighting<Pose2>},
    {"VERTEX_XY", 3, "VERTEX_XY i x y", readLandmarkVertex<Pose2>},
    {"EDGE2", 11, "EDGE2 i j x y theta I11 I12 I22 I33 I13 I23",
     readPoseEdge<readPose2, readToroInformation>},
    {"VERTEX2", 4, "VERTEX2 i x y theta", readPoseVertex<readPose2>},
    {"EDGE_BEARING_SE2_XY", 4, "EDGE_BEARING_SE2_XY i j theta I11", readBearing},
    {"EDGE_PRIOR_SE2", 10, "EDGE_PRIOR_SE2 i x y theta I11 I12 I13 I22 I23 I33", readPosePrior<readPose2>},
    {"EDGE_SE2_PRIOR", 10, "EDGE_SE2_PRIOR i x y theta I11 I12 I13 I22 I23 I33", readPosePrior<readPose2>},
    {"EDGE_PRIOR_SE2_XY", 6, "EDGE_PRIOR_SE2_XY i x y I11 I12 I22", readPositionPrior},
}};

constexpr std::array<Tag<Pose3>, 8> space_tags{{
    {"EDGE_SE3:QUAT", 30, "EDGE_SE3:QUAT i j x y z qx qy qz qw I11 I12 ... I66",
     readPoseEdge<readQuaternionPose, readInformation<6>>},
    {"VERTEX_SE3:QUAT", 8, "VERTEX_SE3:QUAT i x y z qx qy qz qw", readPoseVertex<readQuaternionPose>},
    {"EDGE_SE3_TRACKXYZ", 12, "EDGE_SE3_TRACKXYZ i j sensor x y z I11 I12 I13 I22 I23 I33",
     readSighting<Pose3>},
    {"VERTEX_TRACKXYZ", 4, "VERTEX_TRACKXYZ i x y z", readLandmarkVertex<Pose3>},
    {"EDGE3", 29, "EDGE3 i j x y z roll pitch yaw I11 I12 ... I66",
     readPoseEdge<readEulerPose, readInformation<6>>},
    {"VERTEX3", 7, "VERTEX3 i x y z roll pitch yaw", readPoseVertex<readEulerPose>},
    {"PARAMS_SE3OFFSET", 8, "PARAMS_SE3OFFSET i x y z qx qy qz qw", readSensor},
    {"EDGE_SE3_PRIOR", 30, "EDGE_SE3_PRIOR i sensor x y z qx qy qz qw I11 I12 ... I66",
     readPosePrior<readQuaternionPose>},
}};

constexpr const char* fix_form = "FIX i";

/// The first line that showed whether the graph is in the plane or in space.
struct FirstLine {
  std::string tag;
  int number = 0;
};

class Reader {
 public:
  explicit Reader(const std::string& file) { plane_.graph.file = space_.graph.file = file; }

  AnyPoseGraph read() {
    Lines line(plane_.graph.file);
    return read(line);
  }
  /// Reads all lines of the file.
  AnyPoseGraph readWhole(const NumberedLines& lines) {
    Lines line(plane_.graph.file, lines);
    return read(line);
  }
  /// Reads some lines of the file.
  AnyPoseGraph read(const NumberedLines& lines) {
    is_part_ = true;
    Lines line(plane_.graph.file, lines);
    return read(line);
  }

 private:
  AnyPoseGraph read(Lines& line) {
    const std::string& file = plane_.graph.file;
    bool is_empty = true;
    for (; line.next(); is_empty = false) readLine(line);
    if (is_empty && !is_part_)
      fail("empty-file", file + ": the file is empty; a pose graph has a line for each edge", file);
    if (in_space_.number != 0) return finish(std::move(space_));
    return finish(std::move(plane_));
  }

  void readLine(Lines& line) {
    if (readTagged(line, plane_tags, plane_, in_plane_, in_space_)) return;
    if (readTagged(line, space_tags, space_, in_space_, in_plane_)) return;
    if (line.tag() == "FIX") return readFix(line);
    unknown_.add(line.tag());
  }

  template <class Pose, std::size_t N>
  static bool readTagged(Lines& line, const std::array<Tag<Pose>, N>& tags, RawGraph<Pose>& raw,
                         FirstLine& own, const FirstLine& other) {
    for (const Tag<Pose>& tag : tags) {
      if (tag.name != line.tag()) continue;
      if (own.number == 0) own = {std::string(tag.name), line.lineNumber()};
      if (other.number != 0) {
        line.fail(fmt::format(
            "{} and {} of line {} do not belong together: one is in the plane, one in space; make "
            "two files",
            tag.name, other.tag, other.number));
      }
      line.expect(tag.words, tag.form);
      tag.read(raw, line);
      return true;
    }
    return false;
  }

  void readFix(Lines& line) {
    line.expect(1, fix_form);
    do {
      fixed_.push_back({line.id(), line.lineNumber()});
    } while (!line.atEnd());
  }

  template <class Pose>
  PoseGraph<Pose> finish(RawGraph<Pose>&& raw) {
    if (!is_part_ && raw.graph.edges.empty() && raw.graph.sightings.empty() && raw.graph.bearings.empty() &&
        raw.graph.pose_priors.empty() && raw.graph.position_priors.empty()) {
      std::string found;  // names from a file of another kind
      for (const auto& [tag, lines] : unknown_.lines)
        found += (found.empty() ? ", its lines begin with " : ", ") + tag;
      fail("no-edges",
           raw.graph.file + ": the file has no edge" + found +
               "; a pose graph has lines EDGE_SE2, EDGE_SE3:QUAT, EDGE2 or EDGE3",
           raw.graph.file);
    }
    raw.fixed = std::move(fixed_);
    const std::vector<std::string> skipped = unknown_.sentences();
    raw.graph.unknown_tags = std::move(unknown_);
    try {
      return resolve(std::move(raw));
    } catch (const mtk::Error& error) {  // a skipped line may have held what is missing
      if (skipped.empty()) throw;
      throw mtk::Error(std::string(error.id()),
                       fmt::format("{} ({})", error.sentence(), fmt::join(skipped, ", ")),
                       std::string(error.subject()));
    }
  }

  RawGraph<Pose2> plane_;
  RawGraph<Pose3> space_;
  FirstLine in_plane_, in_space_;
  bool is_part_ = false;
  std::vector<FixedVertex> fixed_;
  UnknownTags unknown_;
};

}  // namespace

std::vector<LineForm> lineForms() {
  std::vector<LineForm> forms;
  const auto add = [&](std::string_view name, int words, const char* form) {
    int ids = 0;  // words of the form after the tag
    for (const std::string_view word : {" i", " j", " sensor"})
      ids += (std::string(form) + " ").find(std::string(word) + " ") != std::string::npos ? 1 : 0;
    forms.push_back({name, ids, words, form});
  };
  for (const auto& tag : plane_tags) add(tag.name, tag.words, tag.form);
  for (const auto& tag : space_tags) add(tag.name, tag.words, tag.form);
  add("FIX", 1, fix_form);
  return forms;
}

}  // namespace g2o

void UnknownTags::add(std::string_view tag) {
  constexpr std::size_t longest = 40;
  const std::string name = shortened(tag, longest);
  if (const auto known = lines.find(name); known != lines.end()) {
    ++known->second;
  } else if (lines.size() < most) {
    lines.emplace(name, 1);
  } else {
    ++others;
  }
}

std::vector<std::string> UnknownTags::sentences() const {
  const auto sentence = [](int count, const std::string& which) {
    return fmt::format("skipped {} line{} with {}", count, count == 1 ? "" : "s", which);
  };
  std::vector<std::string> all;
  for (const auto& [tag, count] : lines) all.push_back(sentence(count, "the unknown tag " + tag));
  if (others > 0) all.push_back(sentence(others, "other unknown tags"));
  return all;
}

AnyPoseGraph readPoseGraph(const std::string& file) {
  if (!isContainer(file)) return g2o::Reader(file).read();
  const Container container(file);
  container.requireContent(ContainerContent::graph);
  container.requireWhole();
  NumberedLines lines = readLinesOfPart(container, 0, 1);
  lines.sort();
  return g2o::Reader(file).readWhole(lines);
}

AnyPoseGraph parsePoseGraph(const std::string& file, const NumberedLines& lines) {
  return g2o::Reader(file).read(lines);
}

GraphLine kindOfLine(std::string_view line) {
  const auto word = [&line] {
    const std::size_t first = std::min(line.find_first_not_of(" \t\r"), line.size());
    const std::size_t end = std::min(line.find_first_of(" \t\r", first), line.size());
    const std::string_view result = line.substr(first, end - first);
    line.remove_prefix(end);
    return result;
  };
  using Kind = GraphLine::Kind;
  GraphLine result;
  const std::string_view tag = word();
  const auto is_known = [&](const auto& tags) {
    return std::any_of(tags.begin(), tags.end(), [&](const auto& known) { return known.name == tag; });
  };
  if (tag != "FIX" && !is_known(g2o::plane_tags) && !is_known(g2o::space_tags)) return result;
  if (!parseNumber(word(), result.id)) return result;
  if (tag == "FIX") {
    result.kind = Kind::fix;
  } else if (tag.starts_with("VERTEX")) {
    result.kind = Kind::vertex;
  } else if (tag.starts_with("PARAMS")) {
    result.kind = Kind::sensor;
  } else if (tag.find("PRIOR") != std::string_view::npos) {
    result.kind = Kind::prior;
  } else if (parseNumber(word(), result.to)) {
    result.kind = Kind::edge;
  }
  return result;
}

}  // namespace slom::io
