// As it should be: refused with the expected message, and only with MUST_FAIL.
#ifdef MUST_FAIL
static_assert(false, "the expected message");
#endif
