/// Types of variables that the file describes by fields: RuntimeTypes, and C++ types that no program registered.
#pragma once

#include <iosfwd>
#include <memory>
#include <optional>
#include <string>

#include "slom/stored_problem.hpp"

namespace slom::archive_text {

/// Returns the fields as text: `"pose" se3 "gain" vector 2`.
std::string textOf(const RuntimeType& type);
/// Reads fields up to the end of the stream. Returns no type if the text is not such fields. Throws [slom.bad-type].
std::shared_ptr<const RuntimeType> readType(std::istream& is, const std::string& name);

/// Returns the type with these parts, whose components have these names.
std::shared_ptr<const RuntimeType> describedType(std::string name, const tape::VariableType& parts,
                                                 const std::vector<std::string>& components);
/// Returns the functions for values whose numbers lie at `layout`. They are written number by number and read as
/// values of the RuntimeType.
detail::StoredVariable describedVariable(std::string name, std::type_index store,
                                         std::shared_ptr<const RuntimeType> type, tape::Layout layout);

/// Returns whether the parts have the same coordinates and move alike. Vectors that follow one another are one.
bool areAlike(const tape::VariableType& a, const tape::VariableType& b);

}  // namespace slom::archive_text
