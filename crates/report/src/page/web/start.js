// Starts every diagram of the page with its part of the data block.
document.documentElement.classList.add("scripted");
const parts = JSON.parse(document.getElementById("data").textContent);
document.querySelectorAll(".responses").forEach((root, n) => responses(root, parts[n]));
