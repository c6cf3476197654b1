/// The exception of the project: a stable id, the subject, its value and the remedy, in one sentence.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace mtk {

/// what() reads `[id] sentence`; id() is stable between versions, so that programs can branch on it.
class Error : public std::runtime_error {
 public:
  Error(std::string id, const std::string& sentence)
      : std::runtime_error("[" + id + "] " + sentence), id_(std::move(id)) {}

  const std::string& id() const noexcept { return id_; }

 private:
  std::string id_;
};

}  // namespace mtk

namespace MTK = mtk;
