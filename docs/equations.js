// Sets the equations of a page by KaTeX, which stands on the site; they remain readable as TeX without it.
document.querySelectorAll(".arithmatex").forEach((place) => {
  const tex = place.textContent.replace(/^\s*\\\[/, "").replace(/\\\]\s*$/, "");
  katex.render(tex, place, { displayMode: true, throwOnError: true });
});
