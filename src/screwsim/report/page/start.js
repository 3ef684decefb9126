// Unpack the library and the data, draw, and draw again when the theme or the width changes.

let data;

function complain(text) {
  const fault = document.getElementById("fault");
  fault.textContent = text;
  fault.hidden = false;
}

function drawAll() {
  if (data.figures.length) pick(picked);
}

function whenNarrowOrWide(act) {
  let narrow = window.innerWidth < 640;
  window.addEventListener("resize", () => {
    if (narrow === window.innerWidth < 640) return;
    narrow = !narrow;
    act();
  });
}

async function begin() {
  if (typeof DecompressionStream === "undefined") {
    complain("This browser is too old for the drawings of this page (it lacks DecompressionStream, which all browsers have had since 2023). The tables are complete.");
    return;
  }
  const library = document.createElement("script");
  library.textContent = await inflated("data-library");
  document.head.append(library);
  data = unpack(await inflated("data-document"));
  data.columns = columnsOf();
  picked = data.start.case;
  if (data.axes.length && data.figures.length) {
    fillControls();
    fillPicker();
  }
  for (const form of document.forms) form.addEventListener("submit", (event) => event.preventDefault());
  drawAll();
  for (const query of ["(prefers-color-scheme: dark)", "print"]) window.matchMedia(query).addEventListener("change", drawAll);
  whenNarrowOrWide(drawAll);
  markCut();
  window.addEventListener("resize", markCut);
  document.documentElement.dataset.ready = "yes";
}

begin();
