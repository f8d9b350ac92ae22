#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace puppetwarp::tests {

//! How a program ended and what it said.
struct CommandResult {
    int exit_code = -1;  //!< -1 when a signal ended it
    int signal = 0;      //!< or 0
    std::string output;  //!< standard output
    std::string errors;  //!< standard error
};

//! Runs a program without a shell and waits for it.
//! \param arguments  the program's path first.
//! \param in_child   called in the child before the program starts: limits, signals, working folder.
CommandResult run_command(const std::vector<std::string>& arguments, const std::function<void()>& in_child = {});

//! Runs the puppetwarp command of this build.
CommandResult puppetwarp_command(std::vector<std::string> arguments, const std::function<void()>& in_child = {});

//! A folder that is there as long as this is.
class TemporaryFolder {
public:
    TemporaryFolder();
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }
    std::string operator/(const std::string& name) const { return (path_ / name).string(); }

private:
    std::filesystem::path path_;
};

//! All bytes of a file; empty when it is not there.
std::string bytes_of(const std::filesystem::path& path);

//! Writes a file plainly.
void put_bytes(const std::filesystem::path& path, const std::string& bytes);

}  // namespace puppetwarp::tests
