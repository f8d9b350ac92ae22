#include "model/folder_listing.h"

#include <puppetwarp/base/errors.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

namespace puppetwarp::ui {
namespace {

namespace fs = std::filesystem;

class FolderListingTest : public testing::Test {
protected:
    void SetUp() override {
        fs::create_directories(folder / "Zoo");
        fs::create_directories(folder / "attic");
        for (const char* name : {"b.PNG", "a.jpeg", "c.txt", "d.puppet.json", ".hidden.png"})
            std::ofstream(folder / name) << "0123456789";
        fs::create_symlink(folder / "nowhere.png", folder / "broken.png");
    }
    void TearDown() override { fs::remove_all(folder); }

    std::vector<std::string> names(FileKind kind) const {
        std::vector<std::string> result;
        for (const FolderEntry& entry : list_folder(folder, kind)) result.push_back(entry.name);
        return result;
    }

    const fs::path folder = fs::temp_directory_path() / ("puppetwarp-listing-" + std::to_string(::getpid()));
};

TEST_F(FolderListingTest, ShowsFoldersFirstAndWhatCanBeUsed) {
    using testing::ElementsAre;
    EXPECT_THAT(names(FileKind::openable), ElementsAre("attic", "Zoo", "a.jpeg", "b.PNG", "d.puppet.json"));
    EXPECT_THAT(names(FileKind::puppets), ElementsAre("attic", "Zoo", "d.puppet.json"));
    EXPECT_THAT(names(FileKind::pictures), ElementsAre("attic", "Zoo", "a.jpeg", "b.PNG"));
    EXPECT_EQ(list_folder(folder, FileKind::pictures).back().size_bytes, 10u);
}

TEST_F(FolderListingTest, RefusesWhatIsNoFolder) {
    EXPECT_THROW(list_folder(folder / "missing", FileKind::openable), InvalidInput);
    EXPECT_THROW(list_folder(folder / "a.jpeg", FileKind::openable), InvalidInput);
}

TEST(ReadableSizeTest, TakesTheUnitThatFits) {
    EXPECT_EQ(readable_size(0), "0 B");
    EXPECT_EQ(readable_size(999), "999 B");
    EXPECT_EQ(readable_size(12'300), "12 KB");
    EXPECT_EQ(readable_size(3'440'000), "3.4 MB");
    EXPECT_EQ(readable_size(2'000'000'000), "2.0 GB");
}

}  // namespace
}  // namespace puppetwarp::ui
