// Ray files of three programs: read, written, damaged, and traced as they are.
#include "sources/photometry/ray_set.h"

#include <filesystem>

#include "core/files.h"
#include "sampling.h"
#include "sources/lamps/ray_file.h"
#include "sources/profiles/beam_shape.h"
#include "tests/refusal.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;

using test::samples;

RaySet read_sample_rays(const fs::path& path) {
  return read_rays(read_file(path), path.filename().string());
}

RaySet three_rays() {
  RaySet set;
  set.name = "three";
  set.stated_radiant_flux_W = 2.0;
  set.rays = {{{0.001, 0, 0}, {0, 0, 1}, 3.0, 0.0},
              {{0, 0.002, 0}, {0, 0.6, 0.8}, 1.0, 0.0},
              {{0, 0, -0.5}, {-0.6, 0, 0.8}, 0.0, 0.0}};
  return set;
}

// They once reached an assertion of Embree's.
TEST(RaySetFiles, StartsFartherThanAnythingBuiltAreRefused) {
  RaySet set = three_rays();
  set.rays[1].origin_m.y() = 1e25;
  const std::string message = refusal_of([&] { read_tm25(write_tm25(set), "far.tm25ray"); });
  EXPECT_THAT(message, testing::HasSubstr("far.tm25ray: ray 1: found a start"));
  EXPECT_THAT(message, testing::HasSubstr("at most 1e9 m"));
}

void expect_equal(const RaySet& a, const RaySet& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.flux_unit, b.flux_unit);
  EXPECT_EQ(a.stated_radiant_flux_W, b.stated_radiant_flux_W);
  EXPECT_EQ(a.stated_luminous_flux_lm, b.stated_luminous_flux_lm);
  EXPECT_EQ(a.wavelength_m, b.wavelength_m);
  ASSERT_EQ(a.rays.size(), b.rays.size());
  for (size_t i = 0; i < a.rays.size(); ++i) {
    ASSERT_EQ(a.rays[i].origin_m, b.rays[i].origin_m) << i;
    ASSERT_EQ(a.rays[i].direction, b.rays[i].direction) << i;
    ASSERT_EQ(a.rays[i].flux, b.rays[i].flux) << i;
    ASSERT_EQ(a.rays[i].wavelength_m, b.rays[i].wavelength_m) << i;
  }
}

// One lamp in two formats; 10,000 rays of one program in two of its formats.
TEST(RaySamples, AreAllReadAndAgreeAcrossFormats) {
  PHOTORQUE_NEEDS_THIRD_PARTY("photometry");
  const auto compare = [&](const char* first, const char* second, double tolerance) {
    const RaySet a = read_sample_rays(samples() / first), b = read_sample_rays(samples() / second);
    ASSERT_EQ(a.rays.size(), b.rays.size());
    for (size_t i = 0; i < a.rays.size(); ++i) {
      ASSERT_NEAR((a.rays[i].origin_m - b.rays[i].origin_m).norm(), 0.0, tolerance);
      ASSERT_NEAR((a.rays[i].direction - b.rays[i].direction).norm(), 0.0, tolerance);
      ASSERT_NEAR(a.rays[i].flux, b.rays[i].flux, tolerance * a.rays[i].flux + 1e-12);
    }
  };
  compare("synthetic/gauss3.tm25ray", "synthetic/gauss3.dat", 1e-9);
  compare("synthetic/core3_halo12_20pct.tm25ray", "synthetic/core3_halo12_20pct.dat", 1e-9);
  compare("rays/Cyl10k.1.tm25ray", "rays/Cyl10k.1.ray", 1e-6);
  const RaySet osram = read_sample_rays(samples() / "rays/farfield.TM25ray");
  EXPECT_EQ(osram.rays.size(), 100000u);
  EXPECT_EQ(osram.stated_radiant_flux_W, 1.0);
  EXPECT_NEAR(*osram.wavelength_m, 500e-9, 1e-15);
  const RaySet cylinder = read_sample_rays(samples() / "rays/Cyl10k.1.tm25ray");
  EXPECT_EQ(cylinder.flux_unit, RaySet::FluxUnit::lumen);
  EXPECT_EQ(cylinder.stated_luminous_flux_lm, 1.0);
  EXPECT_NEAR(cylinder.ray_flux(), 10000.0, 75.0);
}

TEST(RaySamples, ComeBackAsWritten) {
  PHOTORQUE_NEEDS_THIRD_PARTY("photometry");
  for (const char* file :
       {"synthetic/gauss3.tm25ray", "rays/Cyl10k.1.tm25ray", "rays/farfield.TM25ray"}) {
    SCOPED_TRACE(file);
    const RaySet set = read_sample_rays(samples() / file);
    expect_equal(set, read_tm25(write_tm25(set), "written"));
  }
}

// The closed forms of these beams, to the precision of 20,000 rays: a fraction p of them errs by
// √(p(1 − p)/n).
TEST(RaySamples, HoldTheEncircledFluxOfTheirBeam) {
  PHOTORQUE_NEEDS_THIRD_PARTY("photometry");
  const auto check = [&](const char* file, double half_angle_rad, double fraction) {
    const RayLamp lamp(1.0, read_sample_rays(samples() / file));
    const double sigma = std::sqrt(fraction * (1.0 - fraction) / 20000.0);
    EXPECT_NEAR(EncircledFlux(lamp).within(half_angle_rad), fraction, 3.5 * sigma) << file;
  };
  for (const char* file : {"synthetic/gauss3.tm25ray", "synthetic/gauss3.dat"}) {
    check(file, 1.5 * deg, 0.50006);
    check(file, 3.0 * deg, 0.93753);
  }
  check("synthetic/core3_halo12_20pct.dat", 1.5 * deg, 0.40855);
  check("synthetic/core3_halo12_20pct.tm25ray", 3.0 * deg, 0.78192);
}

TEST(RayLamp, GivesEachRayItsShareOfTheFlux) {
  const RayLamp lamp(2.0, three_rays());
  EXPECT_EQ(lamp.power_W(), 2.0);
  int straight = 0, aslant = 0;
  for (const auto& ray : test::rays_of(lamp, 4096)) {
    constexpr double single = 1e-7;  // the precision of rays
    straight += ray.direction == Vec3(0, 0, 1) && ray.origin_m.isApprox(Vec3(0.001, 0, 0), single);
    aslant += ray.direction.isApprox(Vec3(0, 0.6, 0.8), single) &&
              ray.origin_m.isApprox(Vec3(0, 0.002, 0), single);
  }
  EXPECT_EQ(straight, 3072);
  EXPECT_EQ(aslant, 1024);
}

// Found by fuzzing: with nothing but darkness before the last direction all intensities were NaN.
TEST(RayLamp, LightOfTheLastDirectionCounts) {
  const auto ray = [](double sine, double flux) {
    return RaySet::Ray{{0, 0, 0}, {sine, 0, std::sqrt(1.0 - sine * sine)}, flux, 0.0};
  };
  RaySet set;
  for (const double sine : {0.1, 0.2, 0.3, 0.4}) set.rays.push_back(ray(sine, 0.0));
  set.rays.push_back(ray(0.4, 2.0));
  const RayLamp dark_before(1.0, set);
  EXPECT_EQ(dark_before.relative_intensity(0.2), 1.0);
  EXPECT_EQ(dark_before.relative_intensity(0.5), 0.0);
  // Directions that equal the axis to rounding are one.
  set.rays = {ray(0.0, 1.0), ray(0.0, 1.0), ray(0.0, 1.0), ray(1e-160, 1.0), ray(1e-158, 1.0)};
  EXPECT_EQ(RayLamp(1.0, set).relative_intensity(0.0), 1.0);
}

TEST(RaySetFiles, FluxesBeyondEverythingAreRefused) {
  const auto read = [](const std::string& flux) {
    const std::string header = "lt_length_units: meters\nlt_startofdata\n0 0 0 0 0 1 ";
    return read_lighttools_rays(header + flux + "\n", "rays");
  };
  EXPECT_EQ(read("3").rays.size(), 1u);
  for (const char* flux : {"1e300", "1e-300", "0"}) EXPECT_THROW(read(flux), InputError) << flux;
}

// Three of Stokes' numbers and the direction that they refer to, as TM25RaySetTools and tm25ray
// have them, stand after the fluxes.
TEST(Tm25, PolarisationIsPassedOver) {
  const std::string plain = write_tm25(three_rays());
  constexpr size_t flags_at = 256, stokes_at = flags_at + 4 * 5;
  size_t floats = 6;
  for (size_t flag = 2; flag < 5; ++flag) floats += plain[flags_at + 4 * flag] == 1 ? 1 : 0;
  const size_t ray_bytes = 4 * floats, rays_at = plain.size() - 3 * ray_bytes;
  std::string polarised = plain.substr(0, rays_at);
  polarised[stokes_at] = 1;
  for (size_t ray = 0; ray < 3; ++ray) {
    polarised += plain.substr(rays_at + ray * ray_bytes, ray_bytes) + std::string(4 * 6, '\x3f');
  }
  expect_equal(read_tm25(plain, ""), read_tm25(polarised, ""));
}

TEST(Tm25, RefusesDamage) {
  const std::string good = write_tm25(three_rays());
  const auto expect_refused = [](const std::string& bytes, const std::string& words) {
    const std::string message = refusal_of([&] { read_rays(bytes, "lamp.tm25ray"); });
    EXPECT_THAT(message, testing::HasSubstr(words));
    EXPECT_THAT(message, testing::HasSubstr("lamp.tm25ray"));
  };
  const auto patched = [&](size_t at, const std::string& bytes) {
    return std::string(good).replace(at, bytes.size(), bytes);
  };
  expect_equal(three_rays(), [&] {
    RaySet set = read_tm25(good, "");
    for (auto& ray : set.rays) {  // single precision
      for (int k = 0; k < 3; ++k) ray.origin_m[k] = std::round(ray.origin_m[k] * 1e9) / 1e9;
      for (int k = 0; k < 3; ++k) ray.direction[k] = std::round(ray.direction[k] * 1e6) / 1e6;
    }
    return set;
  }());
  expect_refused(patched(4, std::string("\x01\0\0\0", 4)), "version: found 1");
  expect_refused(patched(20, std::string("\xff\xff\xff\xff\xff\xff\xff\x7f", 8)), "at most the 3");
  expect_refused(patched(80, std::string("\xff\xff\xff\x7f", 4)), "names of columns");
  expect_refused(patched(256, std::string("\0\0\0\0", 4)), "without position");
  expect_refused(patched(256, std::string("\x02\0\0\0", 4)), "column flags: found 2");
  expect_refused(patched(20, std::string("\x02\0\0\0\0\0\0\0", 8)), "found 2, expected 3");
  // One wavelength for all, 0.73 where nanometres stand.
  expect_refused(patched(60, std::string("\x01\0\0\0\x48\xe1\x3a\x3f", 8)), "found 0.73");
  expect_refused(patched(good.size() - 4, std::string("\0\0\x80\xbf", 4)), "ray 2: found a flux");
  expect_refused(patched(good.size() - 8, std::string("\0\0\xc0\x7f", 4)), "not finite");
  expect_refused(patched(good.size() - 8, std::string("\0\0\0\0", 4)), "a unit vector");
  expect_refused("", "no known kind");
  for (size_t length = 4; length < good.size(); length += length < 300 ? 1 : 97) {
    EXPECT_THROW(read_rays(good.substr(0, length), "cut"), InputError) << length;
  }
}

TEST(ZemaxRays, RefuseDamage) {
  const std::string good = read_file(outside::reference_data("beams/gauss3_begin.dat"));
  const auto patched = [&](size_t at, const std::string& bytes) {
    return std::string(good).replace(at, bytes.size(), bytes);
  };
  const std::string fifty("\x32\0\0\0", 4);
  EXPECT_EQ(read_zemax_rays(patched(4, fifty), "").rays.size(), 50u);
  EXPECT_THROW(read_zemax_rays(good, ""), InputError);  // 20,000 announced
  std::string bad = patched(4, fifty);
  bad.replace(136, 4, std::string("\x09\0\0\0", 4));
  EXPECT_THROW(read_zemax_rays(bad, ""), InputError);
  for (size_t length = 0; length < 208; ++length) {
    EXPECT_THROW(read_zemax_rays(good.substr(0, length), "cut"), InputError) << length;
  }
}

TEST(LightToolsRays, NameTheLineOfTheMistake) {
  const std::string good =
      "# comment\nlt_length_units: meters\nlt_data_origin: 1 0 0\nlt_radiant_flux: 5\n"
      "lt_startofdata\n1 2 3 0 0 1 0.5\n 0 0 0 0 -1 0 1e0\n";
  const RaySet set = read_rays(good, "lamp.ray");
  ASSERT_EQ(set.rays.size(), 2u);
  EXPECT_EQ(set.rays[0].origin_m, Vec3(2, 2, 3));
  EXPECT_EQ(set.stated_radiant_flux_W, 5.0);
  std::string bad = good;
  bad.replace(bad.find("-1 0 1e0"), 8, "-1 0 off");
  EXPECT_EQ(refusal_of([&] { read_rays(bad, "lamp.ray"); }),
            "lamp.ray:7: column 7: found \"off\", expected a number");
}

TEST(LightToolsRays, TakeNoDecimalCommaNoFluxOfZeroAndEachKeywordOnce) {
  const auto refusal = [](const std::string& header, const std::string& ray) {
    return refusal_of(
        [&] { read_rays("# x\n" + header + "lt_startofdata\n" + ray + "\n", "lamp.ray"); });
  };
  const std::string units = "lt_length_units: meters\n", ray = "1 2 3 0 0 1 0.5";
  EXPECT_EQ(refusal(units + "lt_radiant_flux: 2.5\n", ray), "");
  EXPECT_EQ(refusal(units, "1,2,3,0,0,1,0.5"), "");
  EXPECT_EQ(refusal(units, "1, 2, 3, 0, 0, 1, 0.5"), "");
  EXPECT_EQ(refusal(units + "lt_radiant_flux: 2,5\n", ray),
            "lamp.ray:3: lt_radiant_flux: found \"2,5\", expected a number above 0");
  EXPECT_EQ(refusal(units + "lt_luminous_flux: -1\n", ray),
            "lamp.ray:3: lt_luminous_flux: found \"-1\", expected a number above 0");
  EXPECT_THAT(refusal(units, "1,5 2 3 0 0 1 0.5"), testing::StartsWith("lamp.ray:4: column 1"));
  EXPECT_THAT(refusal(units + units, ray), testing::StartsWith("lamp.ray:3: lt_length_units"));
  EXPECT_THAT(refusal("", ray), testing::HasSubstr("lt_length_units: found no such line"));
}

// The experiment's keys of a file go to the beam; what the file says for itself is said.
TEST(RayFile, IsScaledToItsHeaderWithANotice) {
  const fs::path folder = fs::path(testing::TempDir()) / "ray_set_test";
  write_file_whole(folder / "three.tm25ray", write_tm25(three_rays()));
  std::vector<std::string> notices, inputs;
  SourceContext context;
  context.folder = folder;
  context.notice = [&](const std::string& line) { notices.push_back(line); };
  context.input = [&](const std::string& name, const std::string&) { inputs.push_back(name); };
  const SettingsNode::Table table = {
      {"file", {"three.tm25ray"}},
      {"wavelength_nm", {730.0}},
      {"positions_m",
       {SettingsNode::Array{test::vector_node(0, 0, 1), test::vector_node(1, 0, 1)}}},
      {"direction", test::vector_node(0, 0, -1)}};
  const auto beams = test::make_beams("ray_file", table, context);
  ASSERT_EQ(beams.size(), 2u);
  EXPECT_EQ(beams[1].name, "ray_file[1]");
  EXPECT_EQ(beams[0].emitter, beams[1].emitter);
  EXPECT_DOUBLE_EQ(beams[0].emitter->power_W(), 2.0);
  EXPECT_THAT(notices, testing::Contains(testing::HasSubstr(
                           "sum to 4 W, the file states 2 W; they are scaled by 0.5")));
  EXPECT_THAT(inputs, testing::ElementsAre("three.tm25ray"));
  const auto given =
      test::make_beams("ray_file", test::changed(table, {{"power_W", {7.0}}}), context);
  EXPECT_DOUBLE_EQ(given[0].emitter->power_W(), 7.0);
}

}  // namespace
}  // namespace photorque
