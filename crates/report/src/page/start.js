// Starts every diagram of the page with its part of the data block.
const parts = JSON.parse(document.getElementById("data").textContent);
document.querySelectorAll(".responses").forEach((root, n) => responses(root, parts[n]));
