// Laws of every registered writer.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/resource.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <limits>
#include <thread>

#include "core/errors.h"
#include "core/files.h"
#include "images/writers/kind.h"
#include "images/writers/product.h"
#include "tests/images/sample_product.h"
#include "tests/refusal.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class Writers : public FolderTest {
 protected:
  std::vector<fs::path> entries() const {
    std::vector<fs::path> found;
    for (const auto& entry : fs::directory_iterator(folder)) found.push_back(entry.path());
    std::ranges::sort(found);
    return found;
  }
};

TEST_F(Writers, WriteExactlyTheFilesTheyName) {
  for (const WriterKind& kind : all_writer_kinds()) {
    std::vector<fs::path> paths = kind.write({sample_product(), {}, folder});
    EXPECT_FALSE(paths.empty()) << kind.name;
    for (const fs::path& path : paths) EXPECT_EQ(path.extension(), "." + kind.name);
    std::ranges::sort(paths);
    EXPECT_EQ(paths, entries()) << kind.name;
    for (const fs::path& path : paths) fs::remove(path);
    EXPECT_THAT(kind.write({{}, {}, folder}), IsEmpty()) << kind.name;
  }
}

TEST_F(Writers, PutTheProvenanceInEveryFile) {
  const Provenance provenance = sample_provenance();
  for (const fs::path& path : write_formats(sample_product(), provenance, folder)) {
    const std::string bytes = read_file(path);
    EXPECT_THAT(bytes, HasSubstr(provenance.version)) << path;
    EXPECT_THAT(bytes, HasSubstr(provenance.git_hash)) << path;
    EXPECT_THAT(bytes, HasSubstr(std::to_string(provenance.seed))) << path;
    for (const auto& [file, hash] : provenance.inputs) {
      EXPECT_THAT(bytes, HasSubstr(file)) << path;
      EXPECT_THAT(bytes, HasSubstr(hash)) << path;
    }
  }
}

// Long enough apart for a time of day to differ: OpenImageIO writes one unless it is disabled.
TEST_F(Writers, WriteTheSameBytesASecondLater) {
  const auto first = write_formats(sample_product(), sample_provenance(), folder / "a");
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));
  const auto second = write_formats(sample_product(), sample_provenance(), folder / "b");
  ASSERT_EQ(first.size(), second.size());
  for (size_t i = 0; i < first.size(); ++i) {
    EXPECT_TRUE(read_file(first[i]) == read_file(second[i])) << first[i];
  }
}

// A folder stands where the file should go, so that the last step fails after everything is
// written.
TEST_F(Writers, LeaveNothingWhenTheFileCannotAppear) {
  for (const WriterKind& kind : all_writer_kinds()) {
    const std::vector<fs::path> paths = kind.write({sample_product(), {}, folder});
    fs::remove_all(folder);
    fs::create_directories(paths.front() / "in the way");
    EXPECT_THROW(kind.write({sample_product(), {}, folder}), InputError) << kind.name;
    EXPECT_EQ(entries(), std::vector<fs::path>{paths.front()}) << kind.name;
    EXPECT_TRUE(fs::exists(paths.front() / "in the way")) << kind.name;
  }
}

TEST_F(Writers, RefuseFoldersThatCannotBeWritten) {
  std::ofstream(folder / "file") << "no folder";
  for (const WriterKind& kind : all_writer_kinds()) {
    EXPECT_THROW(kind.write({sample_product(), {}, folder / "file"}), InputError) << kind.name;
    // Read-only even for the administrator.
    if (!fs::is_directory("/proc/self")) continue;
    EXPECT_THROW(kind.write({sample_product(), {}, "/proc/self"}), InputError) << kind.name;
  }
}

// Makes writing fail after some bytes: no file may be longer than a limit.
class LongestFile {
 public:
  explicit LongestFile(size_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~LongestFile() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  LongestFile(const LongestFile&) = delete;
  LongestFile& operator=(const LongestFile&) = delete;

 private:
  void (*handler_)(int);
  rlimit before_;
};

TEST_F(Writers, ReportFailedWrites) {
  for (const WriterKind& kind : all_writer_kinds()) {
    uintmax_t shortest = std::numeric_limits<uintmax_t>::max();
    for (const fs::path& path : kind.write({sample_product(), {}, folder})) {
      shortest = std::min(shortest, fs::file_size(path));
      fs::remove(path);
    }
    for (const uintmax_t limit : {uintmax_t{0}, shortest / 2, shortest - 1}) {
      {
        const LongestFile longest(limit);
        EXPECT_THROW(kind.write({sample_product(), {}, folder}), InputError)
            << kind.name << ", " << limit;
      }
      EXPECT_THAT(entries(), IsEmpty()) << kind.name << ", " << limit;
    }
  }
}

TEST_F(Writers, RefuseReadOnlyFolders) {
  if (::geteuid() == 0) GTEST_SKIP() << "the administrator may write everywhere";
  fs::permissions(folder, fs::perms::owner_read | fs::perms::owner_exec);
  for (const WriterKind& kind : all_writer_kinds()) {
    EXPECT_THROW(kind.write({sample_product(), {}, folder}), InputError) << kind.name;
  }
  fs::permissions(folder, fs::perms::owner_all);
  EXPECT_THAT(entries(), IsEmpty());
}

TEST_F(Writers, SurviveTextThatIsNotUtf8) {
  Product product = sample_product();
  Provenance provenance = sample_provenance();
  const std::string bad = "<\xFF\x01&\"plate\xE2\x82";
  product.maps[0].title = product.maps[0].unit = product.maps[0].x_label = bad;
  product.tables[0].title = product.tables[0].columns[0].name = bad;
  product.plots[0].title = product.plots[0].x_label = product.plots[0].curves[0].label = bad;
  product.quantities[0].name = bad;
  provenance.inputs[0].first = bad;
  EXPECT_NO_THROW(write_formats(product, provenance, folder));
}

TEST_F(Writers, RejectItemsOfDifferentSizes) {
  Product map_too_short;
  map_too_short.maps = {sample_map()};
  map_too_short.maps[0].value.pop_back();
  EXPECT_THROW(write_formats(map_too_short, {}, folder), InputError);
  Product table_too_short;
  table_too_short.tables = sample_product().tables;
  table_too_short.tables[0].columns[1].values.pop_back();
  EXPECT_THROW(write_formats(table_too_short, {}, folder), InputError);
  Product plot_too_short;
  plot_too_short.plots = {sample_plot()};
  plot_too_short.plots[0].below[0].curves[0].y.pop_back();
  EXPECT_THROW(write_formats(plot_too_short, {}, folder), InputError);
  EXPECT_THAT(entries(), IsEmpty());
}

TEST_F(Writers, NeverShareAFile) {
  Product product = sample_product();
  product.tables[0].name = product.maps[0].name;
  EXPECT_THROW(write_formats(product, {}, folder), InputError);
  product.tables[0].name = "irradiance plate";  // differs from the map, but not as a file
  EXPECT_THROW(write_formats(product, {}, folder), InputError);
  EXPECT_THAT(entries(), IsEmpty());
}

TEST_F(Writers, StayInsideTheirFolder) {
  EXPECT_EQ(file_in("out", "../../etc/passwd", "csv"), fs::path("out/_._.._etc_passwd.csv"));
  EXPECT_EQ(file_in("out", "", "csv"), fs::path("out/unnamed.csv"));
  EXPECT_EQ(file_in("out", "solar array.001", "png"), fs::path("out/solar_array.001.png"));
}

TEST_F(Writers, NameTheFormatsThatExist) {
  const std::string refusal = refusal_of([&] { write_formats({}, {}, folder, {"jpeg"}); });
  EXPECT_THAT(refusal, HasSubstr("jpeg"));
  EXPECT_THAT(refusal, HasSubstr("exr, tiff, png, svg, pdf, csv, json, vtkhdf, h5"));
}

}  // namespace
}  // namespace photorque
