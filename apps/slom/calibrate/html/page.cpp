#include "calibrate/html/page.hpp"

#include "calibrate/html/page_data.hpp"
#include "calibrate/html/page_template.hpp"

namespace slom::app::calib {

std::string toHtml(const Dataset& data, const Result& result, const std::optional<FittedStreams>& streams) {
  const std::string_view page = page_template, mark = "@data@";
  const std::size_t at = page.find(mark);
  return std::string(page.substr(0, at)) + pageData(data, result, streams) +
         std::string(page.substr(at + mark.size()));
}

}  // namespace slom::app::calib
