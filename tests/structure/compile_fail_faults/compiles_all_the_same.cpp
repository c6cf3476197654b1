// Compiles with MUST_FAIL too: "the expected message" never comes.
int main() {}
