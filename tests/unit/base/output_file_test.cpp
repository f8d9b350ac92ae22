#include <puppetwarp/base/output_file.h>

#include <puppetwarp/base/errors.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <thread>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

namespace puppetwarp {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class OutputFileTest : public testing::Test {
protected:
    OutputFileTest() {
        std::string name = (fs::temp_directory_path() / "puppetwarp-test-XXXXXX").string();
        folder = ::mkdtemp(name.data());
    }
    ~OutputFileTest() override {
        std::error_code ignored;
        fs::remove_all(folder, ignored);
    }
    static std::string content(const fs::path& path) {
        std::ifstream stream(path, std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), {}};
    }
    static void store(const fs::path& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }
    static mode_t permissions(const fs::path& path) {
        struct stat status {};
        EXPECT_EQ(::stat(path.c_str(), &status), 0);
        return status.st_mode & 07777;
    }
    std::ptrdiff_t files() const { return std::distance(fs::directory_iterator(folder), {}); }
    static std::string refusal(const fs::path& path) {
        try {
            const OutputFile file(path);
            return "";
        } catch (const InvalidInput& error) {
            return error.what();
        }
    }

    fs::path folder;
};

TEST_F(OutputFileTest, AppearsWholeWithCommit) {
    OutputFile file(folder / "a");
    file.write("one ");
    file.write("two");
    EXPECT_FALSE(fs::exists(folder / "a"));
    EXPECT_TRUE(file.seekable());
    file.commit();
    EXPECT_EQ(content(folder / "a"), "one two");
    EXPECT_EQ(files(), 1);
}

TEST_F(OutputFileTest, WithoutCommitTheOldFileStaysAndNothingIsLeft) {
    store(folder / "a", "old");
    {
        OutputFile file(folder / "a");
        file.write("new");
    }
    EXPECT_EQ(content(folder / "a"), "old");
    EXPECT_EQ(files(), 1);
}

TEST_F(OutputFileTest, KeepsPermissionsAndGivesNewFilesTheUsualOnes) {
    store(folder / "a", "old");
    fs::permissions(folder / "a", fs::perms(0640));
    write_file(folder / "a", "new");
    EXPECT_EQ(permissions(folder / "a"), 0640u);
    const mode_t before = ::umask(027);
    write_file(folder / "b", "new");
    ::umask(before);
    EXPECT_EQ(permissions(folder / "b"), 0640u);
}

TEST_F(OutputFileTest, FollowsSymbolicLinks) {
    fs::create_directory(folder / "sub");
    store(folder / "sub/real", "old");
    fs::create_symlink("sub/real", folder / "link");
    fs::create_symlink("link", folder / "link2");
    write_file(folder / "link2", "new");
    EXPECT_EQ(content(folder / "sub/real"), "new");
    EXPECT_TRUE(fs::is_symlink(folder / "link2") && fs::is_symlink(folder / "link"));
    fs::create_symlink("sub/later", folder / "dangling");
    write_file(folder / "dangling", "made");
    EXPECT_EQ(content(folder / "sub/later"), "made");
    EXPECT_TRUE(fs::is_symlink(folder / "dangling"));
}

TEST_F(OutputFileTest, RefusesWhatCannotBeWritten) {
    EXPECT_THAT(refusal(""), HasSubstr("empty"));
    EXPECT_THAT(refusal(folder), HasSubstr("is a folder"));
    EXPECT_THAT(refusal(folder / "none/a"), HasSubstr("does not exist"));
    store(folder / "file", "x");
    EXPECT_THAT(refusal(folder / "file/a"), HasSubstr("is not a folder"));
    fs::create_symlink("b", folder / "a");
    fs::create_symlink("a", folder / "b");
    EXPECT_THAT(refusal(folder / "a"), HasSubstr("circle"));
    EXPECT_THAT(refusal("/dev/fd/987"), HasSubstr("is not open"));
}

TEST_F(OutputFileTest, RefusesReadOnlyFoldersAndFiles) {
    store(folder / "file", "x");
    fs::permissions(folder / "file", fs::perms(0444));
    fs::create_directory(folder / "shut");
    fs::permissions(folder / "shut", fs::perms(0555));
    fs::permissions(folder, fs::perms(0755));
    // access() asks for the real user, open() for the effective one.
    const bool root = ::geteuid() == 0;
    if (root) {
        ASSERT_EQ(::setresuid(65534, 65534, 0), 0);
    }
    const std::string shut = refusal(folder / "shut/a");
    const std::string file = refusal(folder / "file");
    if (root) {
        ASSERT_EQ(::setresuid(0, 0, 0), 0);
    }
    EXPECT_THAT(shut, HasSubstr("cannot be written: permission denied"));
    EXPECT_THAT(file, HasSubstr("cannot be written: permission denied"));
}

TEST_F(OutputFileTest, WritesPipesDirectly) {
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    std::string received;
    std::thread reader([&] { received = content(folder / "pipe"); });
    {
        OutputFile file(folder / "pipe");
        EXPECT_FALSE(file.seekable());
        file.write("through");
        file.commit();
    }
    reader.join();
    EXPECT_EQ(received, "through");
    EXPECT_TRUE(fs::is_fifo(folder / "pipe"));
}

TEST_F(OutputFileTest, ADescriptorNamedByPathIsWrittenWhereItStands) {
    const int descriptor = ::open((folder / "log").c_str(), O_WRONLY | O_CREAT, 0600);
    ASSERT_EQ(::write(descriptor, "1", 1), 1);
    write_file("/dev/fd/" + std::to_string(descriptor), "2");
    ASSERT_EQ(::write(descriptor, "3", 1), 1);
    ::close(descriptor);
    EXPECT_EQ(content(folder / "log"), "123");
    EXPECT_EQ(files(), 1);
}

TEST_F(OutputFileTest, KnowsStreams) {
    EXPECT_TRUE(OutputFile::is_stream("-"));
    EXPECT_TRUE(OutputFile::is_stream("/dev/stdout"));
    EXPECT_TRUE(OutputFile::is_stream("/dev/fd/2"));
    EXPECT_TRUE(OutputFile::is_stream("/dev/null"));
    EXPECT_FALSE(OutputFile::is_stream(folder));
    EXPECT_FALSE(OutputFile::is_stream(folder / "none"));
    store(folder / "file", "x");
    EXPECT_FALSE(OutputFile::is_stream(folder / "file"));
}

TEST_F(OutputFileTest, AFullDiskIsAFaultOfTheMachine) {
    try {
        OutputFile file("/dev/full");
        file.write("x");
        FAIL();
    } catch (const MachineFault& error) {
        EXPECT_THAT(error.what(), HasSubstr("the disk is full"));
    }
    store(folder / "a", "old");
    auto* const handler = std::signal(SIGXFSZ, SIG_IGN);
    rlimit old{};
    ::getrlimit(RLIMIT_FSIZE, &old);
    rlimit tight = old;
    tight.rlim_cur = 10;
    ::setrlimit(RLIMIT_FSIZE, &tight);
    EXPECT_THROW(write_file(folder / "a", "more than ten bytes"), MachineFault);
    ::setrlimit(RLIMIT_FSIZE, &old);
    std::signal(SIGXFSZ, handler);
    EXPECT_EQ(content(folder / "a"), "old");
    EXPECT_EQ(files(), 1);
}

TEST_F(OutputFileTest, RemovesTheTemporariesOfAnInterruptedProgram) {
    OutputFile first(folder / "a");
    OutputFile second(folder / "b");
    first.write("x");
    EXPECT_EQ(files(), 2);
    OutputFile::remove_temporaries();
    EXPECT_EQ(files(), 0);
}

}  // namespace
}  // namespace puppetwarp
