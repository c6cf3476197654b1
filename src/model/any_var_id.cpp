#include "slom/model/any_var_id.hpp"

namespace slom {

void detail::raiseWrongType(const VariableStoreBase& store, std::string (*asked)()) {
  const std::string own = store.typeName();
  throw Error("slom.wrong-type",
              "the variable is a " + own + ", it was asked for as a " + asked() +
                  "; ask for it by its own type, as<" + own + ">()",
              own);
}

const void* AnyVarID::current() const {
  if (!isValid()) {
    detail::raiseStaleHandle(store_ ? "VarID<" + store_->typeName() + ">" : "AnyVarID", store_ != nullptr);
  }
  return store_->valueAt(ref_.slot);
}

}  // namespace slom
