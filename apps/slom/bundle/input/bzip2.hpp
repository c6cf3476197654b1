// Files compressed by bzip2.
#pragma once

#include <string>
#include <string_view>

namespace slom::app::bundle {

/// By its first bytes, whatever the file is called.
inline bool isBzip2(std::string_view content) { return content.starts_with("BZh"); }

/// Whether this program was built with libbz2.
extern const bool has_bzip2;

/// What `content` held before it was compressed. UserError, naming `file`, when it is damaged, or when this
/// program was built without libbz2.
std::string bzip2Decompressed(const std::string& file, std::string_view content);

}  // namespace slom::app::bundle
