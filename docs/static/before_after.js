// A slider between two pictures: drag it, or use the arrow keys.
document.addEventListener("DOMContentLoaded", () => {
  for (const pair of document.querySelectorAll(".before-after")) {
    const [, after] = pair.querySelectorAll("img");
    if (!after) continue;
    const bar = document.createElement("input");
    Object.assign(bar, { type: "range", min: 0, max: 100, value: 50, step: "any" });
    bar.setAttribute("aria-label", `${pair.dataset.alt}: ${pair.dataset.before} to the left, ${pair.dataset.after} to the right`);
    const show = () => pair.style.setProperty("--cut", `${bar.value}%`);
    bar.addEventListener("input", show);
    pair.append(bar);
    pair.classList.add("wiped");
    show();
  }
});
