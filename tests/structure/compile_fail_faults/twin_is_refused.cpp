// Is refused without MUST_FAIL too.
static_assert(false, "the expected message");
