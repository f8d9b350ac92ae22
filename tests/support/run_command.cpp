#include "support/run_command.h"

#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <memory>
#include <stdexcept>

#include <sys/wait.h>
#include <unistd.h>

namespace puppetwarp::tests {

namespace fs = std::filesystem;

namespace {

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

// Output goes to files without names, not to pipes: nothing can fill up and block.
File unnamed_file() {
    return {std::tmpfile(), &std::fclose};
}

std::string content(std::FILE* file) {
    std::rewind(file);
    std::string text;
    std::array<char, 4096> buffer{};
    while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), file))
        text.append(buffer.data(), count);
    return text;
}

}  // namespace

CommandResult run_command(const std::vector<std::string>& arguments, const std::function<void()>& in_child) {
    const File output = unnamed_file();
    const File errors = unnamed_file();
    std::vector<char*> argv;
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    const pid_t child = ::fork();
    if (child < 0) throw std::runtime_error("fork failed");
    if (child == 0) {
        ::dup2(::fileno(output.get()), STDOUT_FILENO);
        ::dup2(::fileno(errors.get()), STDERR_FILENO);
        // Shells leave what runs in the background deaf to this one.
        std::signal(SIGINT, SIG_DFL);
        if (in_child) in_child();
        ::execv(argv[0], argv.data());
        ::_exit(127);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    CommandResult result;
    if (WIFEXITED(status)) result.exit_code = WEXITSTATUS(status);
    if (WIFSIGNALED(status)) result.signal = WTERMSIG(status);
    result.output = content(output.get());
    result.errors = content(errors.get());
    return result;
}

CommandResult puppetwarp_command(std::vector<std::string> arguments, const std::function<void()>& in_child) {
    arguments.insert(arguments.begin(), PUPPETWARP_BINARY_DIR "/puppetwarp");
    return run_command(arguments, in_child);
}

TemporaryFolder::TemporaryFolder() {
    std::string name = (fs::temp_directory_path() / "puppetwarp-test-XXXXXX").string();
    if (!::mkdtemp(name.data())) throw std::runtime_error("cannot make a folder for a test");
    path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code error;
    // A test may have taken away the right to write.
    fs::permissions(path_, fs::perms::owner_all, error);
    fs::remove_all(path_, error);
}

std::string bytes_of(const fs::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

void put_bytes(const fs::path& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
}

}  // namespace puppetwarp::tests
