// IES TM-25-13, "Ray file format for the description of the emission property of light sources".
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/little_endian.h"
#include "core/text/parse.h"
#include "sources/photometry/ray_set.h"

namespace photorque {
namespace {

constexpr double mm = 1e-3, nm = 1e-9;
constexpr int version_2013 = 2013;
constexpr size_t header_bytes = 256;
constexpr size_t texts = 9, text_characters = 1000;  // UTF-32
constexpr size_t column_name_bytes = 512;            // 128 characters of UTF-32
constexpr float absent = std::numeric_limits<float>::quiet_NaN();

// Columns of a ray, in the order of the file.
enum Column : size_t {
  position,
  direction,
  radiant,
  wavelength,
  luminous,
  stokes,
  tristimulus,
  spectrum,
  column_kinds
};
// Number of floats per column: Stokes' parameters have three, their reference direction has three
// more.
constexpr std::array<size_t, column_kinds> column_floats = {3, 3, 1, 1, 1, 6, 2, 1};

struct Tm25Header {
  uint64_t rays = 0;
  int32_t spectra = 0, more_columns = 0, text_bytes = 0;
  std::array<bool, column_kinds> has{};
  size_t floats_per_ray = 0;
};

std::optional<double> stated(float value) {
  return value > 0.0f && std::isfinite(value) ? std::optional<double>(value) : std::nullopt;
}

int32_t size_claim(LittleEndianReader& in, const char* what) {
  const int32_t value = in.int32(what);
  if (value < 0) throw InputError(in.where(), what, std::to_string(value), "a number >= 0");
  return value;
}

Tm25Header read_tm25_header(LittleEndianReader& in, RaySet& set) {
  if (in.take(4, "magic") != "TM25") {
    throw InputError(in.where(), "magic", "other bytes", "\"TM25\"");
  }
  const int32_t version = in.int32("version");
  if (version != version_2013) {
    throw InputError(in.where(), "version", std::to_string(version), "2013");
  }
  in.int32("creation method");
  set.stated_luminous_flux_lm = stated(in.float32("luminous flux"));
  set.stated_radiant_flux_W = stated(in.float32("radiant flux"));
  Tm25Header header;
  header.rays = in.unsigned_integer<uint64_t>("number of rays");
  in.skip(28, "date");
  in.int32("start position");
  const int32_t spectrum_kind = in.int32("kind of spectrum");
  const float wavelength_nm = in.float32("wavelength");
  in.skip(8, "range of wavelengths");
  if (spectrum_kind == 1 && stated(wavelength_nm)) {
    // For example micrometres in a field of nanometres.
    if (!(wavelength_nm >= 10.0F && wavelength_nm <= 1e6F)) {
      throw InputError(in.where(), "wavelength", shortest(wavelength_nm) + " nm",
                       "10 nm to 1000000 nm");
    }
    set.wavelength_m = nm * wavelength_nm;
  }
  header.spectra = size_claim(in, "number of spectra");
  header.more_columns = size_claim(in, "number of further columns");
  header.text_bytes = size_claim(in, "length of the text");
  in.skip(168, "reserved bytes");
  for (size_t c = 0; c < column_kinds; ++c) {
    const int32_t flag = in.int32("column flags");
    if (flag != 0 && flag != 1) {
      throw InputError(in.where(), "column flags", std::to_string(flag), "0 or 1");
    }
    header.has[c] = flag == 1;
    if (header.has[c]) header.floats_per_ray += column_floats[c];
  }
  header.floats_per_ray += static_cast<size_t>(header.more_columns);
  if (!header.has[position] || !header.has[direction]) {
    throw InputError(in.where(), "column flags", "rays without position or direction", "both");
  }
  if (!header.has[radiant] && !header.has[luminous]) {
    throw InputError(in.where(), "column flags", "rays without flux", "radiant or luminous flux");
  }
  return header;
}

// Converts UTF-32 to ASCII; other characters become question marks.
std::string ascii_of(std::string_view utf32) {
  std::string text;
  for (size_t i = 0; i + 4 <= utf32.size(); i += 4) {
    const bool is_ascii =
        utf32[i + 1] == 0 && utf32[i + 2] == 0 && utf32[i + 3] == 0 && (utf32[i] & 0x80) == 0;
    if (is_ascii && utf32[i] == 0) break;
    text += is_ascii ? utf32[i] : '?';
  }
  return text;
}

void skip_spectra(LittleEndianReader& in, int32_t spectra) {
  uint64_t bytes = 0;
  for (int32_t i = 0; i < spectra; ++i) {
    const auto points = static_cast<uint64_t>(size_claim(in, "points of a spectrum"));
    in.skip(8 * points, "spectrum");
    bytes += 4 + 8 * points;
  }
  // The block is padded to a multiple of 32 bytes.
  in.skip((32 - bytes % 32) % 32, "filling after the spectra");
}

RaySet::Ray read_ray(LittleEndianReader& in, const Tm25Header& header, RaySet::FluxUnit unit) {
  RaySet::Ray ray;
  for (int k = 0; k < 3; ++k) ray.origin_m[k] = mm * in.float32("rays");
  for (int k = 0; k < 3; ++k) ray.direction[k] = in.float32("rays");
  const auto column = [&](Column c) { return header.has[c] ? in.float32("rays") : absent; };
  const float radiant_flux = column(radiant);
  const float wavelength_nm = column(wavelength);
  const float luminous_flux = column(luminous);
  ray.flux = unit == RaySet::FluxUnit::watt ? radiant_flux : luminous_flux;
  if (const auto known_nm = stated(wavelength_nm)) ray.wavelength_m = nm * *known_nm;
  size_t rest = static_cast<size_t>(header.more_columns);
  for (const Column c : {stokes, tristimulus, spectrum})
    rest += header.has[c] ? column_floats[c] : 0;
  in.skip(4 * rest, "rays");
  return ray;
}

}  // namespace

RaySet read_tm25(const std::string& bytes, const std::string& name) {
  LittleEndianReader in(bytes, name);
  RaySet set;
  set.format = "TM-25-13";
  const Tm25Header header = read_tm25_header(in, set);
  set.name = ascii_of(in.take(4 * text_characters, "name"));
  in.skip(4 * text_characters * (texts - 1), "descriptions");
  if (header.spectra > 0) skip_spectra(in, header.spectra);
  in.skip(static_cast<uint64_t>(header.more_columns) * column_name_bytes, "names of columns");
  in.skip(static_cast<uint64_t>(header.text_bytes), "text");
  const uint64_t there = in.left() / (4 * header.floats_per_ray);
  require_affordable(header.rays, there, {name});
  set.flux_unit = header.has[radiant] ? RaySet::FluxUnit::watt : RaySet::FluxUnit::lumen;
  set.rays.reserve(header.rays);
  for (uint64_t i = 0; i < header.rays; ++i) {
    set.rays.push_back(read_ray(in, header, set.flux_unit));
    require_sound(set.rays.back(), i, {name});
  }
  if (in.left() >= 4 * header.floats_per_ray) {
    throw InputError({name}, "number of rays", std::to_string(header.rays),
                     std::to_string(there) + ", for which there are bytes");
  }
  require_flux(set, {name});
  return set;
}

std::string write_tm25(const RaySet& set) {
  const bool has_wavelengths =
      std::any_of(set.rays.begin(), set.rays.end(),
                  [](const RaySet::Ray& ray) { return ray.wavelength_m > 0.0; });
  const bool watts = set.flux_unit == RaySet::FluxUnit::watt;
  LittleEndianWriter out;
  out.text("TM25", 4);
  out.int32(version_2013);
  out.int32(0);  // simulated
  out.float32(set.stated_luminous_flux_lm.value_or(absent));
  out.float32(set.stated_radiant_flux_W.value_or(absent));
  out.unsigned_integer(static_cast<uint64_t>(set.rays.size()));
  out.zeros(28);  // no date
  out.int32(0);   // start positions anywhere
  out.int32(has_wavelengths ? 2 : set.wavelength_m ? 1 : 0);
  const double wavelength_nm = set.wavelength_m ? *set.wavelength_m / nm : absent;
  for (int i = 0; i < 3; ++i) out.float32(wavelength_nm);
  for (int i = 0; i < 3; ++i) out.int32(0);  // spectra, further columns, text
  out.zeros(header_bytes - out.bytes().size());
  for (const bool has : {true, true, watts, has_wavelengths, !watts, false, false, false}) {
    out.int32(has ? 1 : 0);
  }
  for (const char c : std::string_view(set.name).substr(0, text_characters)) {
    out.unsigned_integer(static_cast<uint32_t>(static_cast<unsigned char>(c)));
  }
  out.zeros(header_bytes + 32 + 4 * text_characters * texts - out.bytes().size());
  for (const RaySet::Ray& ray : set.rays) {
    for (int k = 0; k < 3; ++k) out.float32(ray.origin_m[k] / mm);
    for (int k = 0; k < 3; ++k) out.float32(ray.direction[k]);
    if (watts) out.float32(ray.flux);
    if (has_wavelengths) out.float32(ray.wavelength_m > 0.0 ? ray.wavelength_m / nm : absent);
    if (!watts) out.float32(ray.flux);
  }
  return std::move(out.bytes());
}

}  // namespace photorque
