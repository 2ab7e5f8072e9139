// The charts of the report as plain data, for whoever draws them.
#pragma once

#include "core/product.h"
#include "diagnosis/diagnosis.h"

namespace photorque {

// Blue is what was found, vermilion the nominal model, grey what was measured: in every chart and
// in the legend of the page. Colours that colour-blind readers tell apart: M. Okabe and K. Ito,
// "Color Universal Design" (2008).

// Torque without a law about the three axes, with bands of one standard error.
Plot empirical_plot(const EmpiricalTorque& torque);

// chi² per reading of every channel under the nominal model.
BarChart misfit_chart(const Where& where);
// What the difference is a function of.
BarChart dependence_chart(const Where& where);

// Log evidence of the best alternatives; those that the recordings rule out are left out.
// `of`: which domain's, where motion and light were recorded together.
BarChart ranking_chart(const Diagnosis& diagnosis, const std::string& of = {});

// Readings beside both models, where the channel has them, above the residuals of both; what was
// held out is shaded, twice the noise of a reading dotted.
Plot channel_plot(const ChannelSeries& channel, const RecordingSeries& recording);

}  // namespace photorque
