// What the tests in C++ share: a check that says what failed, and goes on.
#ifndef FOVEAL_CULL_TESTS_EXPECT_HPP
#define FOVEAL_CULL_TESTS_EXPECT_HPP

#include <cstdio>

static int failures = 0;

static void expect(bool holds, const char *text) {
    if (!holds) {
        std::fprintf(stderr, "not so: %s\n", text);
        ++failures;
    }
}

#endif
