// Styles of pictures.
#pragma once

namespace photorque {

enum class PictureStyle {
  page,   // with title and caption
  paper,  // only axes and legend; letters have 7 points if the picture is 9 cm wide
  slide,  // with title; letters are a third larger than on a page
};

// Page width relative to PictureStyle::page; the size of letters in points is constant.
constexpr double page_scale(PictureStyle style) {
  return style == PictureStyle::page ? 1.0 : style == PictureStyle::paper ? 0.62 : 0.75;
}
// Pixels per point of a PNG: sharp on high-resolution displays and in print.
constexpr double pixels_per_point(PictureStyle style) {
  return style == PictureStyle::paper ? 4.0 : style == PictureStyle::slide ? 3.0 : 2.0;
}

}  // namespace photorque
