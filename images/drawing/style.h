// Styles of pictures.
#pragma once

namespace photorque {

enum class PictureStyle {
  page,   // with title and caption
  paper,  // axes and legend alone, letters of 7 points where the picture is 9 cm wide
  slide,  // with title, letters a third larger than on a page
};

// Widths of pages against those of PictureStyle::page: letters keep their size in points.
constexpr double page_scale(PictureStyle style) {
  return style == PictureStyle::page ? 1.0 : style == PictureStyle::paper ? 0.62 : 0.75;
}
// Pixels per point of a PNG, so that it stays sharp on dense displays and in print.
constexpr double pixels_per_point(PictureStyle style) {
  return style == PictureStyle::paper ? 4.0 : style == PictureStyle::slide ? 3.0 : 2.0;
}

}  // namespace photorque
