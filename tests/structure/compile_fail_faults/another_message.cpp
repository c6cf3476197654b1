// A file that fails to compile with MUST_FAIL, but not for the expected reason.
#ifdef MUST_FAIL
static_assert(false, "some other message");
#endif
