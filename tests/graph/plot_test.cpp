// Pictures and pages.
#include "graph/graph_command.hpp"

namespace slom::app::graph {
namespace {

using testing::Json;
using testing::runIn;
using testing::TemporaryFolder;
using testing::unit3;
using testing::unit6;

/// The file DIR/`name` that --plot writes.
std::string plotted(const std::string& content, const std::string& name) {
  const TemporaryFolder folder;
  const auto result = runIn(folder, content, {"--plot", "DIR/" + name});
  EXPECT_EQ(result.errors, "");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_TRUE(result.output.ends_with("\nwritten: " + name + "\n")) << result.output;
  return slom::testing::readFile(folder / name);
}

/// A square of 8.4 m, with one edge that closes the loop and a landmark in the middle; pose 2 does not exist.
const std::string square =
    "VERTEX_SE2 5 0 8.4 0\nVERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 8.4 0 0\nVERTEX_SE2 3 8.4 8.4 0\nVERTEX_XY 9 4.2 "
    "4.2\nFIX 0\n"
    "EDGE_SE2 0 1 8.4 0 0" +
    unit3 + "EDGE_SE2 1 3 0 8.4 0" + unit3 + "EDGE_SE2 5 3 8.4 0 0" + unit3 + "EDGE_SE2 5 0 0 -8.4 0" +
    unit3 + "EDGE_SE2_XY 0 9 4.2 4.2 1 0 1\n";

TEST(GraphPlot, Picture) {
  const std::string svg = plotted(square, "map.svg");
  EXPECT_TRUE(svg.starts_with(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 900 940\" width=\"900\" height=\"940\">\n"
      "<title>map.g2o: 4 poses, 1 edge that closes a loop</title>\n"))
      << svg;
  EXPECT_NE(
      svg.find("<path class=\"edge\" stroke-width=\"0.7\" stroke-opacity=\"0.55\" d=\"M30 870L30 30\"/>"),
      std::string::npos)
      << svg;
  EXPECT_NE(svg.find("<path class=\"path\" stroke-width=\"1.6\" stroke-opacity=\"1\" d=\"M30 870L870 870L870 "
                     "30L30 30\"/>"),
            std::string::npos)
      << svg;
  EXPECT_NE(svg.find("<path class=\"mark\" stroke-width=\"4\" d=\"M450 450h0\"/>"), std::string::npos) << svg;
  EXPECT_NE(svg.find("<circle class=\"fixed\" stroke-width=\"2\" cx=\"30\" cy=\"870\" r=\"5\"/>"),
            std::string::npos)
      << svg;
  EXPECT_NE(
      svg.find("d=\"M30 906.00v8M30 910.00h100.00m0 -4v8\"/>\n<text x=\"140.00\" y=\"915.00\">1</text>"),
      std::string::npos)
      << svg;
  EXPECT_TRUE(svg.ends_with("</svg>\n"));
}

TEST(GraphPlot, PictureOfATallAndOfAFlatGraph) {
  const std::string tall =
      plotted("VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 0 80 0\nEDGE_SE2 0 1 0 80 0" + unit3, "map.svg");
  EXPECT_NE(tall.find("viewBox=\"0 0 900 1700\""), std::string::npos) << tall;
  EXPECT_NE(tall.find("d=\"M450 1630L450 30\""), std::string::npos) << tall;
  const std::string flat = plotted("EDGE_SE2 0 1 80 0 0" + unit3, "map.svg");
  EXPECT_NE(flat.find("d=\"M30 30L870 30\""), std::string::npos) << flat;
  const std::string point = plotted("EDGE_SE2 0 1 0 0 0" + unit3, "map.svg");
  EXPECT_NE(point.find("d=\"M450 30L450 30\""), std::string::npos) << point;
}

TEST(GraphPlot, NamesAreEscaped) {
  const TemporaryFolder folder;
  slom::testing::writeFile(folder / "a<b&c.g2o", "EDGE_SE2 0 1 1 0 0" + unit3);
  for (const std::string name : {"map.svg", "map.html"}) {
    testing::runGraph({(folder / "a<b&c.g2o").string(), "--quiet", "--plot", (folder / name).string()});
    EXPECT_EQ(slom::testing::readFile(folder / name).find("a<b&c"), std::string::npos) << name;
  }
  EXPECT_NE(slom::testing::readFile(folder / "map.svg").find("<title>a&lt;b&amp;c.g2o: "), std::string::npos);
  EXPECT_NE(slom::testing::readFile(folder / "map.html").find("\"name\":\"a\\u003cb&c.g2o\""),
            std::string::npos);
}

/// The data of a page.
Json dataOf(const std::string& html) {
  const std::string before = "\nconst data = ", after = ";\nconst canvas = ";
  const std::size_t begin = html.find(before) + before.size();
  return Json::parse(html.substr(begin, html.find(after) - begin));
}

TEST(GraphPlot, PageOfAGraphInThePlane) {
  const Json data = dataOf(plotted(square, "map.html"));
  EXPECT_EQ(data["name"], "map.g2o");
  EXPECT_EQ(data["flat"], true);
  const long h = 70711;  // 100000 is half the diagonal
  EXPECT_EQ(data["poses"], (std::vector<long>{-h, -h, 0, h, -h, 0, h, h, 0, -h, h, 0}));
  EXPECT_EQ(data["path"], (std::vector<int>{0, 1, 1, 2, 2, 3}));
  EXPECT_EQ(data["closures"], (std::vector<int>{0, 3}));
  EXPECT_EQ(data["landmarks"], (std::vector<long>{0, 0, 0}));
  EXPECT_EQ(data["fixed"], (std::vector<int>{0}));
}

TEST(GraphPlot, PageOfAGraphInSpaceNeedsNothingElse) {
  const std::string html = plotted("EDGE_SE3:QUAT 0 1 0 0 10 0 0 0 1" + unit6, "map.html");
  const Json data = dataOf(html);
  EXPECT_EQ(data["flat"], false);
  EXPECT_EQ(data["poses"], (std::vector<long>{0, 0, -100000, 0, 0, 100000}));
  EXPECT_EQ(html.find("http"), std::string::npos);
  EXPECT_EQ(html.find(" src="), std::string::npos);
  EXPECT_NE(html.find("prefers-color-scheme: dark"), std::string::npos);
  for (const char* event : {"pointermove", "wheel", "ArrowLeft", "ArrowUp"}) {
    EXPECT_NE(html.find(event), std::string::npos) << event;
  }
}

}  // namespace
}  // namespace slom::app::graph
