#include <puppetwarp/base/errors.h>

#include <gtest/gtest.h>

namespace puppetwarp {
namespace {

TEST(Errors, ReadAsOneLine) {
    EXPECT_STREQ(InvalidInput("a.png", "is a folder", "name a file").what(), "a.png: is a folder (name a file)");
    EXPECT_STREQ(MachineFault("a.png", "the disk is full").what(), "a.png: the disk is full");
    EXPECT_STREQ(InvalidInput("a\nb", "first\nsecond\t.", "why\rnot\n").what(), "a b: first second (why not)");
}

TEST(Errors, NameFoldersOfDotsAsTheyAreCalled) {
    EXPECT_STREQ(InvalidInput(".", "is a folder").what(), ".: is a folder");
    EXPECT_STREQ(InvalidInput("../..", "is a folder.", "name a file.").what(), "../..: is a folder (name a file)");
}

TEST(Errors, KeepTheirParts) {
    const InvalidInput error("a.png", "is a folder", "name a file");
    EXPECT_EQ(error.subject(), "a.png");
    EXPECT_EQ(error.reason(), "is a folder");
    EXPECT_EQ(error.advice(), "name a file");
}

TEST(Errors, TellInputFromMachine) {
    EXPECT_THROW(throw InvalidInput("a", "b"), Error);
    EXPECT_THROW(throw MachineFault("a", "b"), Error);
    EXPECT_FALSE((std::is_base_of_v<InvalidInput, MachineFault>));
    EXPECT_FALSE((std::is_base_of_v<MachineFault, InvalidInput>));
}

}  // namespace
}  // namespace puppetwarp
